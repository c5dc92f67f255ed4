"""Plans read back from the documents that they were written to, for viewers and for other programs' formats."""

from flatgrasp_cli.results.saved.models import SavedDocument, SavedGrasp, SavedObject, SavedSilhouette
from flatgrasp_cli.results.saved.reading import is_document, parse_document, read_documents, stem_of

__all__ = [
    "SavedDocument",
    "SavedGrasp",
    "SavedObject",
    "SavedSilhouette",
    "is_document",
    "parse_document",
    "read_documents",
    "stem_of",
]
