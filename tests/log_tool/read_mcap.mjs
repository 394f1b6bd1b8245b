// Reads an MCAP file with @mcap/core and compares it with what the log says.
// Usage: node read_mcap.mjs FILE.mcap [EXPECTED.json]; without EXPECTED it prints the number of messages of each topic.
// EXPECTED: {"counts": {topic: n}, "facts": [{"topic", "at", "path": [...], "value" | "base64"}]}; a path begins with
// "log_us", "publish_us" or "message", `at` counts the messages of the topic by their log times.
// The script runs with the packages in procs/viewer/page/node_modules. It also checks all checksums, that both ways of
// reading give the same messages, and that every message can be decoded by the schema in the file.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const require = createRequire(join(here, "../../procs/viewer/page/package.json"));
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { crc32 } = require("@foxglove/crc");
const { decompress } = require("fzstd");
const protobuf = require("protobufjs");
const descriptor = require("protobufjs/ext/descriptor");

const [path, expectedPath] = process.argv.slice(2);
const bytes = readFileSync(path);
const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
};

/** All messages by topic, in the order of the index. */
async function readByIndex() {
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  assert.ok(reader.chunkIndexes.length > 0, "the file has an index");
  const byTopic = new Map();
  let last = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    assert.ok(message.logTime >= last, "the index gives messages by their log times");
    last = message.logTime;
    const { topic } = reader.channelsById.get(message.channelId);
    if (!byTopic.has(topic)) byTopic.set(topic, []);
    byTopic.get(topic).push({ ...message, data: Uint8Array.from(message.data) });
  }
  checkStatistics(reader, byTopic);
  return { reader, byTopic };
}

function checkStatistics(reader, byTopic) {
  const { statistics, channelsById, schemasById } = reader;
  assert.equal(statistics.channelCount, channelsById.size);
  assert.equal(statistics.schemaCount, schemasById.size);
  assert.equal(statistics.chunkCount, reader.chunkIndexes.length);
  assert.equal(Number(statistics.messageCount), [...byTopic.values()].reduce((sum, list) => sum + list.length, 0));
  for (const [id, count] of statistics.channelMessageCounts) {
    assert.equal(byTopic.get(channelsById.get(id).topic).length, Number(count));
  }
  const times = [...byTopic.values()].flat().map((message) => message.logTime).sort((a, b) => (a < b ? -1 : 1));
  assert.equal(statistics.messageStartTime, times[0]);
  assert.equal(statistics.messageEndTime, times.at(-1));
}

/** Number of messages when the file is read from its beginning, and the checksum that the data end with. */
function readAsStream() {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  let messages = 0;
  let dataCrc;
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Message") ++messages;
    if (record.type === "DataEnd") dataCrc = record.dataSectionCrc;
  }
  assert.ok(reader.done());
  return { messages, dataCrc };
}

/** Decodes with the schema of the file alone. */
function decoderOf(schema) {
  if (schema.encoding === "jsonschema") {
    assert.equal(JSON.parse(new TextDecoder().decode(schema.data)).type, "object");
    return (data) => JSON.parse(new TextDecoder().decode(data));
  }
  assert.equal(schema.encoding, "protobuf");
  const set = descriptor.FileDescriptorSet.decode(schema.data);
  const type = protobuf.Root.fromDescriptor(set).lookupType(schema.name);
  return (data) => type.toObject(type.decode(data), { longs: Number, enums: String, defaults: true });
}

function checkFact(fact, list, decode) {
  const found = list[fact.at < 0 ? list.length + fact.at : fact.at];
  const where = `${fact.topic} [${fact.at}] ${fact.path.join(".")}`;
  assert.ok(found, `${where}: there are ${list.length} messages`);
  let value = {
    log_us: Number(found.logTime / 1000n),
    publish_us: Number(found.publishTime / 1000n),
    message: decode(found.data),
  };
  for (const key of fact.path) value = value?.[key];
  if (fact.base64 !== undefined) {
    assert.equal(Buffer.from(value).toString("base64"), fact.base64, where);
  } else if (typeof fact.value === "number") {
    assert.ok(Math.abs(value - fact.value) <= 1e-6 * Math.max(1, Math.abs(fact.value)), `${where}: ${value}, expected ${fact.value}`);
  } else {
    assert.deepEqual(value, fact.value, where);
  }
}

const { reader, byTopic } = await readByIndex();
const stream = readAsStream();
assert.equal(stream.messages, Number(reader.statistics.messageCount));
const dataEnd = Number(reader.footer.summaryStart) - 13;
assert.equal(stream.dataCrc, crc32(bytes.subarray(0, dataEnd)), "checksum of the data");

const decoders = new Map();
for (const channel of reader.channelsById.values()) {
  const decode = decoderOf(reader.schemasById.get(channel.schemaId));
  decoders.set(channel.topic, decode);
  for (const message of byTopic.get(channel.topic)) decode(message.data);
}

const counts = Object.fromEntries([...byTopic].map(([topic, list]) => [topic, list.length]).sort());
if (expectedPath === undefined) {
  console.log(JSON.stringify(counts, null, 1));
} else {
  const expected = JSON.parse(readFileSync(expectedPath, "utf8"));
  assert.deepEqual(counts, expected.counts);
  for (const fact of expected.facts) checkFact(fact, byTopic.get(fact.topic) ?? [], decoders.get(fact.topic));
  console.log(`${Object.keys(counts).length} topics, ${expected.facts.length} facts`);
}
