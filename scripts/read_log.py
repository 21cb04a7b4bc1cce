#!/usr/bin/env python3
"""Reads a log of `hwasp deploy` with the `mcap` package of PyPI (`pip install mcap`): another reader than the program's own.

    scripts/read_log.py LOG.mcap

Prints what the log is of, and for each channel how many messages it has. Checks that each message is JSON with the keys that the
channel's schema names, and that messages are in order of time. Exit status 1 if one is not.
"""

import json
import sys

from mcap.reader import make_reader


def main(path):
    counts, last, wrong = {}, 0, 0
    with open(path, "rb") as file:
        reader = make_reader(file, validate_crcs=True)
        for metadata in reader.iter_metadata():
            about = json.loads(metadata.metadata["about"])
            print(f"{about['what']} of {about['run']}, {about['experiment']}, program {about['version']}")
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            described = json.loads(schema.data)["properties"]
            told = json.loads(message.data)
            unknown = set(told) - set(described)
            if schema.encoding != "jsonschema" or channel.message_encoding != "json" or unknown or message.log_time < last:
                print(f"{channel.topic} at {message.log_time}: {unknown or 'out of order'}")
                wrong += 1
            last = message.log_time
        statistics = reader.get_summary().statistics
    for topic, count in sorted(counts.items()):
        print(f"{topic:<14} {count:>7}")
    if sum(counts.values()) != statistics.message_count:
        print(f"the summary says {statistics.message_count} messages")
        wrong += 1
    return 1 if wrong or not counts else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
