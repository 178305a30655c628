"""The interior-point method for the energy-optimal run, and the proof of its optimum."""
