"""Loss models of drives, one file a kind."""

from railjoule.core.drive.build import make_drive
from railjoule.core.drive.drive import Drive

__all__ = ["Drive", "make_drive"]
