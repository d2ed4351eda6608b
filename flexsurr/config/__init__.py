"""Typed configuration: what a person may write, checked before anything runs."""
