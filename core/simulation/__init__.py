"""What happens when a plan meets reality."""
