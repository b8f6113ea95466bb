"""Modules of the scripts for studies. docs/study.md describes the files and the statistics."""
