"""Reads a recording with the public MCAP library, as a user of the ecosystem would, and prints what it found as JSON."""

import json
import sys

from mcap.reader import NonSeekingReader, make_reader

path, whole = sys.argv[1], sys.argv[2] == "whole"
with open(path, "rb") as file:
    # A file that was cut has no index at its end: it is read from its beginning.
    reader = make_reader(file) if whole else NonSeekingReader(file)
    found = {"statistics": None, "topics": {}, "metadata": {}}
    if whole:
        found["statistics"] = reader.get_summary().statistics.message_count
        found["metadata"] = {it.name: it.metadata for it in reader.iter_metadata()}
    try:
        for schema, channel, message in reader.iter_messages(log_time_order=whole):
            topic = found["topics"].setdefault(
                channel.topic,
                {
                    "schema": schema.name,
                    "encodings": [schema.encoding, channel.message_encoding],
                    "properties": sorted(json.loads(schema.data)["properties"]),
                    "messages": [],
                },
            )
            topic["messages"].append([message.log_time, json.loads(message.data)])
    except Exception as error:  # the end of a file that was cut
        if whole:
            raise
        found["cut"] = type(error).__name__
json.dump(found, sys.stdout)
