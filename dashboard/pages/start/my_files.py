"""The server's folder on Start: its scenario files with title and date, each opened by its name."""

from datetime import datetime

from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.scenario_folder import ListedFile
from railjoule.dashboard.state.files import FilesModel

EMPTY = (
    "Nothing saved yet. \u201cSave scenario\u201d beside the other pages saves here, and scenario files that are "
    "put into the folder appear here."
)
FILES_CSS = """
.my-files { padding: 4px 20px 4px; }
.my-files table { width: 100%; table-layout: fixed; }
.my-files td, .my-files th { text-align: left; padding: 3px 14px 3px 0; vertical-align: baseline; white-space: normal;
  overflow-wrap: anywhere; }
.my-files th:first-child { width: 34%; }
.my-files .date { width: 126px; padding-right: 0; white-space: nowrap; }
.my-files td.date { color: var(--rj-ink2); }
.my-files button { min-height: 24px; padding: 0; border: 0; background: none; text-align: left; overflow-wrap: anywhere;
  font: 600 13px/1.3 var(--rj-font); color: var(--rj-accent); cursor: pointer; }
.my-files button:hover { text-decoration: underline; }
.my-files button:active { color: var(--rj-ink); }
.my-files button:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 2px; }
.my-files .refused { color: var(--rj-warn); }
@media (max-width: 899px) { .my-files { padding: 4px 14px; } }
@media (max-width: 599px) {
  .my-files table, .my-files tbody { display: block; }
  .my-files thead { display: none; }
  .my-files tr { display: flex; flex-wrap: wrap; gap: 0 8px; padding: 4px 0; border-bottom: 1px solid var(--rj-line); }
  .my-files td { padding: 0; border: 0; min-width: 0; }
  .my-files td:first-child { flex: 0 0 100%; }
}
"""


def files_html(files: FilesModel) -> Markup:
    """Return the heading and the table of the folder's files."""
    label = "" if files.folder is None else files.folder.label
    note = "scenario files in the folder"
    heading = markup('<h2 class="begin">My files <span class="muted">{} {}</span></h2>', note, label)
    pieces: list[Markup] = []
    listing = files.listing
    if files.refusal:
        pieces.append(markup('<p class="error" role="alert">{}</p>', files.refusal))
    elif listing is not None and not listing.files:
        pieces.append(markup('<p class="muted">{}</p>', EMPTY))
    elif listing is not None:
        head = Markup('<th scope="col">Name</th><th scope="col">Title</th><th scope="col" class="date">Changed</th>')
        rows = joined([_row(file, file.name == files.current) for file in listing.files])
        pieces.append(
            markup('<table aria-label="My files"><thead><tr>{}</tr></thead><tbody>{}</tbody></table>', head, rows)
        )
    if listing is not None and listing.more:
        pieces.append(markup('<p class="muted">{} more files are not listed: open them as a file.</p>', listing.more))
    return markup("{}<div class=my-files>{}</div>", heading, joined(pieces))


def _row(file: ListedFile, is_open: bool) -> Markup:
    name = markup("<b>{}</b>", file.name)
    if not file.refusal:
        name = markup(
            '<button type="button" data-ask="open_saved" data-name="{0}" aria-label="Open {0}">{0}</button>', file.name
        )
    mark = Markup(' <span class="muted small">open</span>') if is_open else ""
    about = markup('<span class="refused">Cannot be opened: {}</span>', file.refusal) if file.refusal else file.title
    changed = datetime.fromtimestamp(file.changed_s)
    date = f"{changed.day} {changed:%b %Y, %H:%M}"
    return markup("<tr><td>{}{}</td><td>{}</td><td class=date>{}</td></tr>", name, mark, about, date)
