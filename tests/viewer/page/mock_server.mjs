// A small vismap-viewer for work on the page: it serves a map over HTTP and WebSocket without a bus.
// mock_server.mjs [--port N] [--page FOLDER] [--map FOLDER with mesh.ply and objects.json] [--grow BLOCKS_PER_TICK]
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { computedMap, mapOfFolder } from "./mock_map.mjs";
import { answer } from "./mock_answers.mjs";
import { pictureBytes } from "./page_bytes.mjs";

const here = dirname(fileURLToPath(import.meta.url));
const kTypes = { ".html": "text/html; charset=utf-8", ".js": "text/javascript", ".css": "text/css", ".txt": "text/plain; charset=utf-8" };

/** A frame of a WebSocket from server to page. */
function frame(opcode, payload) {
  const size = payload.length;
  const head = Buffer.alloc(size < 126 ? 2 : size < 65536 ? 4 : 10);
  head[0] = 0x80 | opcode;
  if (size < 126) head[1] = size;
  else if (size < 65536) head.writeUInt16BE(size, 2), (head[1] = 126);
  else head.writeBigUInt64BE(BigInt(size), 2), (head[1] = 127);
  return Buffer.concat([head, payload]);
}

/** Reads the masked frames of a page; small ones only, as the page sends them. */
function* framesOf(state, data) {
  state.rest = Buffer.concat([state.rest, data]);
  while (state.rest.length >= 6) {
    const short = state.rest[1] & 127;
    const head = short === 126 ? 4 : 2;
    const size = short === 126 ? state.rest.readUInt16BE(2) : short;
    if (state.rest.length < head + 4 + size) return;
    const mask = state.rest.subarray(head, head + 4);
    const body = Buffer.from(state.rest.subarray(head + 4, head + 4 + size));
    for (let i = 0; i < size; ++i) body[i] ^= mask[i % 4];
    const opcode = state.rest[0] & 15;
    state.rest = state.rest.subarray(head + 4 + size);
    yield { opcode, body };
  }
}

/** One page that is connected. */
class Client {
  constructor(socket, map, options) {
    Object.assign(this, { socket, map, options, sent: new Map(), bytes: 0, acked: 0, want: { pictures: [] }, said: [] });
    this.state = { rest: Buffer.alloc(0) };
    socket.on("data", (data) => this.take(data));
    socket.on("error", () => {});
  }
  text(json) { this.socket.write(frame(1, Buffer.from(JSON.stringify(json)))); }
  binary(bytes) { this.bytes += bytes.length; this.socket.write(frame(2, bytes)); }
  take(data) {
    for (const { opcode, body } of framesOf(this.state, data)) {
      if (opcode === 8) this.socket.end();
      if (opcode !== 1) continue;
      const message = JSON.parse(body.toString());
      this.said.push(message);
      if (message.kind === "ack") this.acked = message.bytes;
      if (message.kind === "want") this.want = { ...this.want, ...message };
      if (message.kind === "resync") { this.sent.clear(); this.text({ ...this.map.summary(), reset: true }); }
    }
  }
  /** Blocks that the page has not, within the budget. */
  tick() {
    let budget = this.options.blocksPerTick;
    for (const [key, revision] of this.sent) {
      if (!this.map.blocks.has(key) && revision !== "gone") { this.binary(this.map.deletionOf(key)); this.sent.set(key, "gone"); }
    }
    for (const [key, block] of this.map.blocks) {
      if (this.bytes - this.acked > 8e6 || budget <= 0) return;
      if (this.sent.get(key) === block.revision) continue;
      this.sent.set(key, block.revision);
      this.binary(block.bytes);
      --budget;
    }
  }
  waiting() {
    let missing = 0;
    for (const [key, block] of this.map.blocks) if (this.sent.get(key) !== block.revision) ++missing;
    return missing;
  }
}

/** Starts the server. Answers {port, map, clients, close(), dropClients(), setRefuse(now)}: refuse = no new connections. */
export async function startMock({ port = 0, page = join(here, "../../../build/page"), map = computedMap(), blocksPerTick = 1e9 } = {}) {
  const clients = new Set();
  const server = createServer(async (request, response) => {
    const url = new URL(request.url, "http://mock");
    if (url.pathname.startsWith("/api/")) {
      const { status, type, body } = await answer(map, url);
      response.writeHead(status, { "content-type": type }).end(body);
      return;
    }
    const name = url.pathname === "/" ? "index.html" : url.pathname.slice(1);
    try {
      if (name.includes("/")) throw new Error("no folders");
      response.writeHead(200, {
        "content-type": kTypes[extname(name)] ?? "application/octet-stream",
        "content-security-policy": "default-src 'self'; img-src 'self' blob: data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
      }).end(readFileSync(join(page, name)));
    } catch {
      response.writeHead(404).end();
    }
  });
  let refuse = false;
  server.on("upgrade", (request, socket) => {
    if (refuse) return socket.destroy();
    const accept = createHash("sha1").update(`${request.headers["sec-websocket-key"]}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest("base64");
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
    const client = new Client(socket, map, { blocksPerTick });
    clients.add(client);
    socket.on("close", () => clients.delete(client));
    client.text({ kind: "hello", protocol: 1, version: "mock", mode: "live", control: false, source: "mock", class_names: map.classNames });
    client.text(map.summary());
    client.text(map.objectsMessage());
    client.text(map.trajectoryMessage());
  });
  const blocks = setInterval(() => clients.forEach((client) => client.tick()), 50);
  const cameras = setInterval(() => clients.forEach((client) => {
    client.text(map.camerasMessage());
    for (const id of client.want.pictures ?? []) {
      const picture = map.picture(id);
      if (picture) client.binary(pictureBytes(id, picture.json, picture.jpeg));
    }
  }), 500);
  const seconds = setInterval(() => {
    map.second();
    clients.forEach((client) => {
      client.text({ ...map.summary(), waiting: client.waiting() });
      client.text(map.objectsMessage());
      client.text(map.processesMessage());
    });
  }, 1000);
  await new Promise((done) => server.listen(port, "127.0.0.1", done));
  const dropClients = () => clients.forEach((client) => client.socket.destroy());
  const close = async () => {
    [blocks, cameras, seconds].forEach(clearInterval);
    dropClients();
    server.closeAllConnections();
    await new Promise((done) => server.close(done));
  };
  return { port: server.address().port, map, clients, dropClients, close, setRefuse: (now) => (refuse = now) };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const { values } = parseArgs({ options: { port: { type: "string" }, page: { type: "string" }, map: { type: "string" }, grow: { type: "string" } } });
  const map = values.map ? mapOfFolder(values.map) : computedMap();
  const { port } = await startMock({ port: Number(values.port ?? 0), page: values.page, map, blocksPerTick: Number(values.grow ?? 1e9) });
  console.log(`http://127.0.0.1:${port}/`);
}
