"""Loss models of drives, one file each."""

from railjoule.core.drive.drive import Drive
from railjoule.core.drive.kernels import make_drive

__all__ = ["Drive", "make_drive"]
