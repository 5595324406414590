"""Ctrl-C reaches these tests however they are started: a shell that starts programs in the background lets them ignore it."""

import signal

signal.signal(signal.SIGINT, signal.default_int_handler)
