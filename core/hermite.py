"""The cubic through two values with two slopes, of which tables of effort limits and of losses are made."""

import numpy as np

# f = a + b x + c x^2 + d x^3: a = f0, b = s0, and f1 = a + b + c + d with s1 = b + 2 c + 3 d give the other two
HERMITE = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [-3.0, 3.0, -2.0, -1.0], [2.0, -2.0, 1.0, 1.0]])
"""Coefficients of 1, x, x^2, x^3 from the values at 0 and 1 and the slopes there."""
