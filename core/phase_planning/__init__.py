"""Start / cruise / coast / brake runs: planned by searches over tables against speed; behind the strategy `phases`."""
