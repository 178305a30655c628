"""The day as it goes: what differs from the plan, on Drive and on Disturbances."""
