// Reads a bag with readers that are not ours (npm), and compares it with the number of messages that its metadata.yaml
// tells: node check_bag.mjs BAG [--killed]. All messages are decoded by the declarations in the bag itself.
//
// MCAP: by the index, and from start to end as a stream, which a killed recorder's file (--killed) alone can be read by.
// SQLite: by sql.js. Prints one JSON object {topic: number of messages}; status 1: something differs.
import assert from "node:assert";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const require = createRequire(process.env.LAPIS_NODE_MODULES ? `${process.env.LAPIS_NODE_MODULES}/` : import.meta.url);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const { decompress } = require("fzstd");
const initSqlJs = require("sql.js");

const [bag, option] = process.argv.slice(2);
const isKilled = option === "--killed";
const metadata = readFileSync(join(bag, "metadata.yaml"), "utf8");
const files = [...metadata.matchAll(/^ +- path: (\S+)$/gm)].map((match) => match[1]);
const counts = {};
const readers = new Map();

function take(topic, schema, data) {
  counts[topic] = (counts[topic] ?? 0) + 1;
  if (!schema) return;
  if (!readers.has(schema)) readers.set(schema, new MessageReader(parse(schema, { ros2: true })));
  readers.get(schema).readMessage(data);
}

const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };

function streamed(bytes) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  const channels = new Map(), schemas = new Map();
  let number = 0;
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Header") assert.strictEqual(record.profile, "ros2");
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type !== "Message") continue;
    ++number;
    if (!isKilled) continue;
    const { topic, schemaId } = channels.get(record.channelId);
    take(topic, new TextDecoder().decode(schemas.get(schemaId).data), record.data);
  }
  if (!isKilled) assert(reader.done(), "the stream ends before the file");
  return number;
}

async function readMcap(bytes) {
  const number = streamed(bytes);
  if (isKilled) return;
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset) + Number(size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  let indexed = 0, time = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    assert(message.logTime >= time, "messages come in the order of time");
    time = message.logTime;
    const channel = reader.channelsById.get(message.channelId);
    assert.strictEqual(channel.messageEncoding, "cdr");
    assert(channel.metadata.get("offered_qos_profiles").includes("durability"));
    take(channel.topic, new TextDecoder().decode(reader.schemasById.get(channel.schemaId).data), message.data);
    ++indexed;
  }
  assert.strictEqual(indexed, number);
  assert.strictEqual(reader.statistics.messageCount, BigInt(number));
}

async function readSqlite(bytes) {
  const SQL = await initSqlJs();
  const database = new SQL.Database(bytes);
  const rows = (sql) => database.exec(sql)[0]?.values ?? [];
  assert.deepStrictEqual(rows("SELECT schema_version FROM schema"), [[4]]);
  const schemas = new Map(rows("SELECT topic_type, encoded_message_definition FROM message_definitions"));
  const topics = new Map(rows("SELECT id, name, type FROM topics").map(([id, ...topic]) => [id, topic]));
  for (const [id, data] of rows("SELECT topic_id, data FROM messages ORDER BY timestamp, id")) {
    const [name, type] = topics.get(id);
    take(name, schemas.get(type), data);
  }
}

assert(files.length > 0, "metadata.yaml lists no files");
for (const file of files) {
  const bytes = new Uint8Array(readFileSync(join(bag, file)));
  await (file.endsWith(".mcap") ? readMcap(bytes) : readSqlite(bytes));
}
if (!isKilled) {
  const told = [...metadata.matchAll(/name: (\/\S+)[\s\S]*?message_count: (\d+)/g)];
  assert.deepStrictEqual(counts, Object.fromEntries(told.map(([, name, count]) => [name, Number(count)]).filter(([, n]) => n > 0)));
}
console.log(JSON.stringify(counts));
