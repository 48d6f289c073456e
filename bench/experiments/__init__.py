"""Experiments: one file per table or figure of a paper, found by discovery."""
