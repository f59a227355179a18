"""Navigators in processes of their own: the messages, the fence, and both ends of the pipe."""
