"""Requests, the threads that work on them, kernels compiled before the first one, and the runs of all pages."""
