"""Tests of flatgrasp. They run on all cores already, one process each, so numeric libraries get a thread each."""

from flatgrasp_cli.threads import one_thread_each

one_thread_each()
