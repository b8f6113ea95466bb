"""What analyse_study and ask_ratings are made of. docs/study.md describes the files and the statistics."""
