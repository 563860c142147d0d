// Serves generated scenes by the protocol of the viewer (protocol.md), for work on the page without the program.
// node mock_server.mjs [--scene static|moving|shapes|hall|live|server|failed|near|loading] [--objects N] [--page FILE] [--port N]
import {createHash} from 'node:crypto';
import {existsSync, readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {parseArgs} from 'node:util';
import {makeScene} from './mock_scene.mjs';

const socketKey = '258EAFA5-E914-47DA-95CA-C5AB0DC85B11';

// A frame of the WebSocket protocol, never masked.
function socketFrame(payload) {
  const text = typeof payload === 'string';
  const body = Buffer.from(payload);
  const opcode = text ? 0x81 : 0x82;
  if (body.length < 126) return Buffer.concat([Buffer.from([opcode, body.length]), body]);
  const head = Buffer.alloc(body.length < 65536 ? 4 : 10);
  head[0] = opcode;
  head[1] = body.length < 65536 ? 126 : 127;
  if (body.length < 65536) head.writeUInt16BE(body.length, 2);
  else head.writeBigUInt64BE(BigInt(body.length), 2);
  return Buffer.concat([head, body]);
}

// The texts in the masked frames of a browser; all of them are short.
function* socketTexts(data) {
  for (let at = 0; at + 6 <= data.length;) {
    const length = data[at + 1] & 127;
    const mask = data.subarray(at + 2, at + 6);
    if ((data[at] & 15) === 1) yield Buffer.from(data.subarray(at + 6, at + 6 + length).map((byte, k) => byte ^ mask[k & 3])).toString();
    at += 6 + length;
  }
}

function serveSocket(scene, request, socket) {
  const accept = createHash('sha1').update(request.headers['sec-websocket-key'] + socketKey).digest('base64');
  socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
  const send = payload => socket.writable && socket.write(socketFrame(payload));
  const stop = scene.connect(message => send(Buffer.isBuffer(message) ? message : JSON.stringify(message)));
  socket.on('data', data => {
    for (const text of socketTexts(data)) scene.receive?.(JSON.parse(text), message => send(message));
  });
  socket.on('error', () => undefined);
  socket.on('close', () => stop?.());
}

function answer(scene, page, request, response) {
  const url = new URL(request.url, 'http://localhost');
  const address = url.pathname.slice(1);
  if (address === '') {
    response.writeHead(200, {'Content-Type': 'text/html; charset=utf-8'});
    return response.end(readFileSync(page));
  }
  if (!scene.ready()) return response.writeHead(503).end();
  const body = scene.answer(address, url.searchParams);
  if (body === null) return response.writeHead(404).end();
  const bytes = Buffer.isBuffer(body) ? body : Buffer.from(JSON.stringify(body));
  response.writeHead(200, {'Content-Type': Buffer.isBuffer(body) ? 'application/octet-stream' : 'application/json', 'Content-Length': bytes.length});
  return response.end(bytes);
}

export function startMock({scene: kind = 'static', objects = 1000, page, port = 0}) {
  const scene = makeScene(kind, objects);
  const server = createServer((request, response) => answer(scene, page, request, response));
  const sockets = new Set();
  server.on('upgrade', (request, socket) => {
    sockets.add(socket);
    serveSocket(scene, request, socket);
  });
  return new Promise(done => server.listen(port, '127.0.0.1', () => done({
    scene, address: `http://127.0.0.1:${server.address().port}/`,
    stop: () => {
      scene.stop?.();
      for (const socket of sockets) socket.destroy();
      server.closeAllConnections();
      server.close();
    },
  })));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const folder = dirname(fileURLToPath(import.meta.url));
  const {values} = parseArgs({options: {
    scene: {type: 'string', default: 'static'}, objects: {type: 'string', default: '1000'},
    page: {type: 'string', default: join(folder, 'page.html')}, port: {type: 'string', default: '0'},
  }});
  if (!existsSync(values.page)) throw new Error(`${values.page} is missing: run npm run build`);
  const {address} = await startMock({...values, objects: Number(values.objects), port: Number(values.port)});
  console.log(address);
}
