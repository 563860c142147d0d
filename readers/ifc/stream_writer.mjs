// Writes a model stream (docs/formats.md, "Model streams") to standard output.
import {writeSync} from 'node:fs';

const kinds = {model: 1, shape: 2, instance: 3, element: 4, warning: 5, failure: 6, end: 7};

// One record: numbers and texts, little endian.
class Record {
  constructor(kind) {
    this.kind = kind;
    this.parts = [];
    this.bytes = 0;
  }

  add(buffer) {
    this.parts.push(buffer);
    this.bytes += buffer.length;
    return this;
  }

  number32(value) {
    const buffer = Buffer.alloc(4);
    buffer.writeUInt32LE(value);
    return this.add(buffer);
  }

  number64(value) {
    const buffer = Buffer.alloc(8);
    buffer.writeBigUInt64LE(BigInt(value));
    return this.add(buffer);
  }

  // A typed array, whose bytes are those of the machine: node runs on little endian machines alone.
  array(values) {
    return this.add(Buffer.from(values.buffer, values.byteOffset, values.byteLength));
  }

  text(value) {
    const buffer = Buffer.from(value ?? '', 'utf8');
    return this.number32(buffer.length).add(buffer);
  }
}

export class StreamWriter {
  constructor(descriptor = 1) {
    this.descriptor = descriptor;
    this.waiting = [];
    this.waitingBytes = 0;
    const version = Buffer.alloc(4);
    version.writeUInt32LE(1);
    this.push(Buffer.from('OPMODEL\n', 'latin1'), version);
    this.shapes = 0;
  }

  model({unit, up, project}) {
    this.record(new Record(kinds.model).text(unit).text(up).text(project));
  }

  // Returns the number of the shape. vertices: Float64Array of 3 n numbers; triangles: Uint32Array of 3 m indices; error: how far the
  // triangles may be from the true surface.
  shape({vertices, triangles, error}) {
    this.record(new Record(kinds.shape).array(Float64Array.of(error)).number32(vertices.length / 3).number32(triangles.length / 3)
      .array(vertices).array(triangles));
    return this.shapes++;
  }

  // transform: 16 numbers, row by row.
  instance({shape, transform, name, label, type, id, parent, level, material, host, assembly, systems = []}) {
    const record = new Record(kinds.instance).number32(shape).array(Float64Array.from(transform));
    for (const text of [name, label, type, id, parent, level, material, host, assembly]) record.text(text);
    record.number32(systems.length);
    for (const system of systems) record.text(system);
    this.record(record);
  }

  // Says which element comes next. Goes out at once, because the work on the element may crash.
  element(text) {
    this.record(new Record(kinds.element).text(text));
    this.flush();
  }

  warning(text) {
    this.record(new Record(kinds.warning).text(text));
  }

  failure(text) {
    this.record(new Record(kinds.failure).text(text));
    this.flush();
  }

  // lost: [{type, count, first}], leftOut: [{type, count}]
  end({withGeometry, read, lost, leftOut}) {
    const record = new Record(kinds.end).number64(withGeometry).number64(read).number32(lost.length);
    for (const {type, count, first} of lost) record.text(type).number64(count).text(first);
    record.number32(leftOut.length);
    for (const {type, count} of leftOut) record.text(type).number64(count);
    this.record(record);
    this.flush();
  }

  record(record) {
    const head = Buffer.alloc(12);
    head.writeUInt32LE(record.kind);
    head.writeBigUInt64LE(BigInt(record.bytes), 4);
    this.push(head, ...record.parts);
    if (this.waitingBytes > 1 << 20) this.flush();
  }

  push(...buffers) {
    for (const buffer of buffers) this.waitingBytes += buffer.length;
    this.waiting.push(...buffers);
  }

  flush() {
    const bytes = Buffer.concat(this.waiting);
    this.waiting = [];
    this.waitingBytes = 0;
    for (let at = 0; at < bytes.length;) at += this.write(bytes.subarray(at));
  }

  // A pipe that is full refuses bytes if somebody made it non-blocking.
  write(bytes) {
    try {
      return writeSync(this.descriptor, bytes);
    } catch (error) {
      if (error.code !== 'EAGAIN') throw error;
      Atomics.wait(new Int32Array(new SharedArrayBuffer(4)), 0, 0, 5);
      return 0;
    }
  }
}
