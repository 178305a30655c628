"""A lower bound of all runs with one effort in each cell, of drives that take power as soon as they are on."""
