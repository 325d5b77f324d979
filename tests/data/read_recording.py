"""Reads a recording with the public MCAP library, as a user of the ecosystem would, and prints what it found as JSON."""

import json
import sys

from mcap.reader import make_reader
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

path, whole = sys.argv[1], sys.argv[2] == "whole"


def streamed(file):
    """The messages of a file from its beginning on: one that was cut has no index at its end."""
    schemas, channels = {}, {}
    for record in StreamReader(file).records:
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Message):
            channel = channels[record.channel_id]
            yield schemas[channel.schema_id], channel, record


with open(path, "rb") as file:
    found = {"statistics": None, "topics": {}, "metadata": {}}
    if whole:
        reader = make_reader(file)
        found["statistics"] = reader.get_summary().statistics.message_count
        found["metadata"] = {it.name: it.metadata for it in reader.iter_metadata()}
    try:
        for schema, channel, message in reader.iter_messages() if whole else streamed(file):
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
