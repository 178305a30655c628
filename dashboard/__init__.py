"""The browser workbench and the command line; no physics lives here."""
