"""Navigators in separate processes: the frame codecs, the sandbox, and both ends of the pipe."""
