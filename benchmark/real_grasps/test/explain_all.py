#!/usr/bin/python3
"""Writes losses.json into each folder below FOLDER: what scripts/explain says of the run there. test_explained_grasps has many
short runs."""
import json
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "scripts"))
from runs.explanation import as_json, explained  # noqa: E402
from runs.tables import Run  # noqa: E402

for name in sorted(os.listdir(sys.argv[1])):
    folder = os.path.join(sys.argv[1], name)
    with open(os.path.join(folder, "losses.json"), "w") as file:
        json.dump(as_json(explained(Run(folder)))["losses"], file)
