"""Every test works in a folder of its own, where runs/ may come into being."""

import signal

import pytest

# A shell's background jobs ignore it, and what they start does, too.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
