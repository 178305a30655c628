"""A permanent-magnet-assisted synchronous reluctance machine with its own inverter."""
