"""A process that stays: requests come in, a line each, and each gets its answer in a line."""

from flatgrasp_cli.serving.answering import Answerer
from flatgrasp_cli.serving.lines import LONGEST_REQUEST, requests_in
from flatgrasp_cli.serving.sockets import Place, listen, parse_place

__all__ = ["LONGEST_REQUEST", "Answerer", "Place", "listen", "parse_place", "requests_in"]
