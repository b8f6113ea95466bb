#!/usr/bin/env python3
"""replay_table.py TABLE DIR...: one row for each replay of recording, scene and setting, from its summary.json. The
last three parts of DIR name them."""

import csv
import json
import os
import sys

COLUMNS = ('recording', 'scene', 'setting', 'contact_model', 'frames', 'simulated_seconds', 'steps', 'step_time_p50_us',
           'step_time_p99_us', 'deepest_rendered_penetration_m', 'grasps', 'held_at_end', 'state_hash')


def row(folder):
    with open(os.path.join(folder, 'summary.json'), encoding='utf-8') as file:
        summary = json.load(file)
    recording, scene, setting = os.path.normpath(folder).split(os.sep)[-3:]
    found = dict(summary, recording=recording, scene=scene, setting=setting)
    found['step_time_p50_us'] = summary['step_time_us']['p50']
    found['step_time_p99_us'] = summary['step_time_us']['p99']
    found['grasps'] = summary['events'].get('GRASP_BEGIN', 0)
    found['held_at_end'] = ' '.join(summary['objects_held_at_end'])
    return found


def main():
    table, folders = sys.argv[1], sys.argv[2:]
    with open(table, 'w', encoding='utf-8', newline='') as file:
        writer = csv.DictWriter(file, COLUMNS, extrasaction='ignore', lineterminator='\n')
        writer.writeheader()
        writer.writerows(row(folder) for folder in folders)


if __name__ == '__main__':
    main()
