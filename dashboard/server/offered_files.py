"""Hands over a file that was written for one browser, in pieces, and deletes it."""

from tornado.iostream import StreamClosedError
from tornado.web import HTTPError, RequestHandler

from railjoule.dashboard.work.offered import OFFERED

NOT_FOUND = 404
PIECE_BYTES = 2**18


class OfferedFileHandler(RequestHandler):
    """Answers once for each token."""

    async def get(self, token: str) -> None:
        """Send the file of a token."""
        file = OFFERED.take(token)
        if file is None:
            raise HTTPError(NOT_FOUND)
        self.set_header("Content-Type", "application/octet-stream")
        self.set_header("Content-Disposition", f'attachment; filename="{file.name}"')
        self.set_header("Cache-Control", "no-store")
        try:
            with file.path.open("rb") as content:
                while piece := content.read(PIECE_BYTES):
                    self.write(piece)
                    # others have their turns between the pieces
                    await self.flush()
        except StreamClosedError:
            pass
        finally:
            file.drop()
