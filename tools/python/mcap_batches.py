"""MCAP's own writer, for many messages at a time: it takes a microsecond or ten for every single one."""

import numpy as np
from mcap.opcode import Opcode
from mcap.records import MessageIndex
from mcap.writer import Writer

# A record of a message, as in the format's specification: opcode, length of what follows, and that up to the data.
HEAD = [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"), ("publish_time", "<u8")]
BEFORE_CHANNEL = 9  # [bytes] of opcode and length


class BatchIndex(MessageIndex):
    """Times and offsets of a channel's messages, as numbers in numpy's hands."""

    def write(self, stream):
        stream.start_record(Opcode.MESSAGE_INDEX)
        stream.write2(self.channel_id)
        stream.write4(self.records.nbytes)
        stream.write(self.records.tobytes())
        stream.finish_record()


class BatchWriter(Writer):
    def add_batch(self, channels):
        """[(channel's id, times [ns], sequence numbers, encoded rows)], each with its messages in order: one chunk of them
        all, in the order of their times. Chunk, indexes and summary are the base class's, whose fields are private: a test
        reads the file back."""
        records, ids, times = [], [], []
        for channel, time, sequence, rows in channels:
            layout = np.dtype([*HEAD, ("data", rows.dtype)])
            made = np.empty(len(rows), layout)
            made["opcode"], made["length"], made["channel"] = Opcode.MESSAGE, layout.itemsize - BEFORE_CHANNEL, channel
            made["sequence"] = sequence & 0xFFFFFFFF
            made["log_time"] = made["publish_time"] = np.maximum(time, 0)  # the format knows no time before 0
            made["data"] = rows
            records += made.view(f"V{layout.itemsize}").tolist()
            ids.append(np.full(len(rows), channel))
            times.append(made["log_time"])
        ids, times = np.concatenate(ids), np.concatenate(times)
        sizes = np.fromiter(map(len, records), np.int64, len(records))
        order = np.lexsort((ids, times))  # of equal ones, the first stays the first
        builder, statistics = self._Writer__chunk_builder, self._Writer__statistics
        at = np.empty(len(records), np.int64)
        at[order] = builder.count + np.cumsum(sizes[order]) - sizes[order]
        first, last = int(times.min()), int(times.max())
        for channel in np.unique(ids).tolist():
            mine = order[ids[order] == channel]
            builder.message_indices[channel] = BatchIndex(channel, np.column_stack([times[mine], at[mine].astype(np.uint64)]))
            statistics.channel_message_counts[channel] += len(mine)
        builder.record_writer.write(b"".join([records[k] for k in order.tolist()]))
        builder.message_start_time, builder.message_end_time = first, last
        builder.num_messages = len(records)
        statistics.message_start_time = min(first, statistics.message_start_time) if statistics.message_count else first
        statistics.message_end_time = max(last, statistics.message_end_time)
        statistics.message_count += len(records)
        self.flush()
