// Generated scenes for the mock server: boxes that move, their pairs by a grid, octants of a shallow octree, and simple shapes.

export function randomNumbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 4294967296;
  };
}

const side = 100;

function octalKey(x, y, z, levels) {
  let key = 0;
  for (let level = levels - 1; level >= 0; --level) {
    key = key * 8 + ((x >> level) & 1) + 2 * ((y >> level) & 1) + 4 * ((z >> level) & 1);
  }
  return key;
}

// Boxes in octal order, with the size chosen for about one pair for every three objects.
function generate(n) {
  const random = randomNumbers(7);
  const size = side * Math.cbrt(0.35 / n) * 0.75;
  const list = Array.from({length: n}, () => ({at: [random(), random(), random()].map(v => v * side), half: [random(), random(), random()]
    .map(v => size * (0.25 + 0.5 * v)), speed: [random(), random(), random()].map(v => (v - 0.5) * size)}));
  const cell = value => Math.min(1023, Math.floor(value / side * 1024));
  list.forEach(box => box.key = octalKey(...box.at.map(cell), 10));
  return list.sort((a, b) => a.key - b.key);
}

function boxesAt(list, frame) {
  const boxes = new Float32Array(6 * list.length);
  list.forEach((box, k) => {
    for (let axis = 0; axis < 3; ++axis) {
      const at = box.at[axis] + box.speed[axis] * Math.sin(0.3 * frame + k);
      boxes[6 * k + axis] = at - box.half[axis];
      boxes[6 * k + axis + 3] = at + box.half[axis];
    }
  });
  return boxes;
}

function overlap(boxes, a, b) {
  for (let axis = 0; axis < 3; ++axis) {
    if (boxes[6 * a + axis] > boxes[6 * b + axis + 3] || boxes[6 * b + axis] > boxes[6 * a + axis + 3]) return false;
  }
  return true;
}

// All pairs, ascending, by a sweep along x.
export function findPairs(boxes) {
  const n = boxes.length / 6;
  const order = Array.from({length: n}, (_, k) => k).sort((a, b) => boxes[6 * a] - boxes[6 * b]);
  const pairs = [];
  for (let i = 0; i < n; ++i) {
    for (let j = i + 1; j < n && boxes[6 * order[j]] <= boxes[6 * order[i] + 3]; ++j) {
      if (overlap(boxes, order[i], order[j])) pairs.push([Math.min(order[i], order[j]), Math.max(order[i], order[j])]);
    }
  }
  return pairs.sort((p, q) => p[0] - q[0] || p[1] - q[1]);
}

const classes = ['unknown', 'clearance', 'collision', 'touching', 'penetrating', 'contained', 'duplicate'];
const severities = [2, 0, 3, 1, 6, 5, 4];
const severity = row => severities[classes.indexOf(row.class ?? 'unknown')];

const flat = pairs => Buffer.from(Uint32Array.from(pairs.flat()).buffer);
const bytesOf = array => Buffer.from(array.buffer, array.byteOffset, array.byteLength);

// A tetrahedron, a cube and a ball, each from -1 to 1.
function makeShapes() {
  const cube = {vertices: [], triangles: [
    0, 1, 3, 0, 3, 2, 4, 7, 5, 4, 6, 7, 0, 5, 1, 0, 4, 5, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3]};
  for (let k = 0; k < 8; ++k) cube.vertices.push(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  const ball = {vertices: [], triangles: []};
  const [rings, sectors] = [10, 16];
  for (let r = 0; r <= rings; ++r) {
    for (let s = 0; s < sectors; ++s) {
      const [p, q] = [Math.PI * r / rings, 2 * Math.PI * s / sectors];
      ball.vertices.push(Math.sin(p) * Math.cos(q), Math.sin(p) * Math.sin(q), Math.cos(p));
      if (r === rings) continue;
      const [a, b] = [r * sectors + s, r * sectors + (s + 1) % sectors];
      ball.triangles.push(a, a + sectors, b, b, a + sectors, b + sectors);
    }
  }
  return [{vertices: [-1, -1, -1, 1, 1, -1, 1, -1, 1, -1, 1, 1], triangles: [0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2]}, cube, ball];
}

class StaticScene {
  constructor(kind, n) {
    this.kind = kind;
    this.list = generate(n);
    // The first object of `hall` is as large as the scene, so it collides with all others.
    if (kind === 'hall') this.list[0] = {...this.list[0], at: [side / 2, side / 2, side / 2], half: [side / 2, side / 2, side / 2]};
    this.n = n;
    this.frames = kind === 'moving' ? 40 : 1;
    this.shapes = kind === 'shapes' ? makeShapes() : null;
    this.names = n <= 20000 ? this.list.map((_, k) => `part ${k % 7}/plate ${k}`) : null;
    if (this.names) this.names[1 % n] = '<img src=x onerror=alert(1)>';
    // With `near`, the overview has every fourth object.
    this.shown = kind === 'near' ? Uint32Array.from({length: Math.ceil(n / 4)}, (_, k) => 4 * k) : null;
    this.rows = this.shown ? this.shown.length : n;
    this.cache = new Map();
    this.isReady = kind !== 'loading' && kind !== 'failed';
    this.began = Date.now();
  }

  ready() {
    return this.isReady;
  }

  connect(send) {
    if (this.kind === 'failed') {
      send({event: 'progress', what: 'reading', done: 0.2});
      setTimeout(() => send({event: 'failed', message: 'boxes.npy: object 3: the minimum of x is above the maximum'}), 200);
    }
    if (this.isReady) send({event: 'ready'});
    if (this.kind !== 'loading') return undefined;
    let done = 0;
    const timer = setInterval(() => {
      done += 0.2;
      if (done < 1) return send({event: 'progress', what: 'reading', done});
      clearInterval(timer);
      this.isReady = true;
      return send({event: 'ready'});
    }, 150);
    return () => clearInterval(timer);
  }

  frame(f) {
    if (!this.cache.has(f)) {
      const boxes = boxesAt(this.list, f);
      this.cache.set(f, {boxes, pairs: findPairs(boxes)});
    }
    return this.cache.get(f);
  }

  changes(f) {
    // In the first frame, all pairs are new.
    if (f === 0) return {began: this.frame(0).pairs, ended: []};
    const keys = pairs => new Set(pairs.map(String));
    const [now, before] = [this.frame(f).pairs, this.frame(f - 1).pairs];
    const [nowKeys, beforeKeys] = [keys(now), keys(before)];
    return {began: now.filter(pair => !beforeKeys.has(String(pair))), ended: before.filter(pair => !nowKeys.has(String(pair)))};
  }

  view() {
    const edge = side * 0.05;
    return {
      version: '0.2.0', title: `mock ${this.kind}`, kind: 'scene', objects: this.n, shown: this.rows, frames: this.frames, origin: [1000, 2000, 3000],
      bounds: {min: [1000 - edge, 2000 - edge, 3000 - edge], max: [1000 + side + edge, 2000 + side + edge, 3000 + side + edge]}, up: 'z', unit: 'm', margin: 0,
      has: {names: this.names !== null, groups: true, shapes: this.shapes !== null, contacts: this.n <= 20000, classes: this.n <= 20000, events: this.kind === 'moving', search: true,
        near: this.shown !== null, rows: this.shown !== null, details: this.n <= 20000},
      notices: this.shown ? [`${(this.n - this.rows).toLocaleString('en-US')} of ${this.n.toLocaleString('en-US')} boxes are not drawn until you zoom in.`] : [],
      summary: {pairs: this.frame(0).pairs.length, format: 'npy', seconds: {read: 0.1, detect: 0.02}},
    };
  }

  detailsOf(k) {
    return {type: ['plate', 'rib', 'bolt'][k % 3], level: `deck ${k % 2}`, material: 'steel'};
  }

  details() {
    if (this.n > 20000) return null;
    const words = ['', 'plate', 'rib', 'bolt', 'deck 0', 'deck 1', 'steel'];
    const column = detail => Array.from({length: this.rows}, (_, row) => words.indexOf(this.detailsOf(this.objectAt(row))[detail]));
    return {words, type: column('type'), level: column('level'), material: column('material')};
  }

  classCounts(f) {
    if (this.n > 20000) return undefined;
    const words = this.frame(f).pairs.map(pair => this.classOf(...pair));
    return Object.fromEntries([...new Set(words)].map(word => [word, words.filter(other => other === word).length]));
  }

  objectAt(row) {
    return this.shown ? this.shown[row] : row;
  }

  partnerCounts(f) {
    const counts = new Uint32Array(this.n);
    for (const [a, b] of this.frame(f).pairs) {
      counts[a] += 1;
      counts[b] += 1;
    }
    return counts;
  }

  ofRows(values, width) {
    if (!this.shown) return values;
    if (Array.isArray(values)) return [...this.shown].map(object => values[object]);
    const out = new values.constructor(width * this.rows);
    this.shown.forEach((object, row) => out.set(values.subarray(width * object, width * object + width), width * row));
    return out;
  }

  level(k) {
    return 1 + Math.floor(this.list[k].half[0] * 1e6) % 4;
  }

  collisions(f, query) {
    const {pairs, boxes} = this.frame(f);
    const began = new Set(this.changes(f).began.map(String));
    const object = query.get('object');
    const text = (query.get('q') ?? '').toLowerCase();
    const has = (pair, name) => query.get(name) === null || pair.includes(Number(query.get(name)));
    const rows = pairs.filter(pair => has(pair, 'object') && has(pair, 'with'))
      .map(([a, b]) => this.collision(boxes, a, b, began))
      .filter(row => !text || [String(row.a), String(row.b)].includes(text) || row.name_a.includes(text) || row.name_b.includes(text));
    const measure = row => row.depth ?? row.overlap;
    if (query.get('sort') === 'worst') rows.sort((p, q) => severity(q) - severity(p) || measure(q) - measure(p));
    if (query.get('sort') === 'began') rows.sort((p, q) => Number(q.change === 'began') - Number(p.change === 'began'));
    const from = Number(query.get('from') ?? 0);
    return {total: rows.length, rows: rows.slice(from, from + Number(query.get('count') ?? 1e9))};
  }

  collision(boxes, a, b, began) {
    const low = [0, 1, 2].map(k => Math.max(boxes[6 * a + k], boxes[6 * b + k]));
    const high = [0, 1, 2].map(k => Math.min(boxes[6 * a + k + 3], boxes[6 * b + k + 3]));
    const depths = low.map((value, k) => high[k] - value);
    const axis = depths.indexOf(Math.min(...depths));
    const row = {a, b, name_a: this.names?.[a] ?? '', name_b: this.names?.[b] ?? ''};
    if (began.has(String([a, b]))) row.change = 'began';
    const boxOf = k => ({min: [0, 1, 2].map(axis => boxes[6 * k + axis] + 1000 * (axis + 1)), max: [0, 1, 2].map(axis => boxes[6 * k + axis + 3] + 1000 * (axis + 1))});
    if (this.shown && (a % 4 || b % 4)) row.boxes = [boxOf(a), boxOf(b)];
    if (this.n > 20000) return {...row, overlap: depths[axis]};
    row.class = this.classOf(a, b);
    // Depths of shapes that are not convex are lower bounds.
    Object.assign(row, a % 2 ? {depth_kind: 'least'} : {depth_kind: 'at_least', depth_at_most: 2 * depths[axis]});
    const point = low.map((value, k) => 1000 * (k + 1) + 0.5 * (value + high[k]));
    const normal = [0, 1, 2].map(k => Number(k === axis));
    // The depth of the contact is not that of the pair.
    return {...row, depth: depths[axis], contacts: [{point, normal, depth: 0.5 * depths[axis]}]};
  }

  // Every fifth pair only touches.
  classOf(a, b) {
    return (a + b) % 5 === 0 ? 'touching' : 'penetrating';
  }

  worstClasses(f) {
    const worst = new Uint8Array(this.n).fill(255);
    for (const [a, b] of this.frame(f).pairs) {
      const code = classes.indexOf(this.classOf(a, b));
      for (const k of [a, b]) if (worst[k] === 255 || severities[code] > severities[worst[k]]) worst[k] = code;
    }
    return worst;
  }

  object(f, k) {
    if (!(k < this.n)) return null;
    const {boxes, pairs} = this.frame(f);
    const partners = pairs.filter(pair => pair.includes(k)).map(([a, b]) => a === k ? b : a).sort((a, b) => a - b);
    const corner = from => [0, 1, 2].map(axis => boxes[6 * k + from + axis] + 1000 * (axis + 1));
    const row = this.shown ? (k % 4 === 0 ? k / 4 : -1) : k;
    return {index: k, name: this.names?.[k] ?? '', details: this.detailsOf(k), box: {min: corner(0), max: corner(3)}, row, code: '{1,4}',
      level: this.level(k), groups: 1 << k % 3, partner_count: partners.length, partners: partners.slice(0, 1000)};
  }

  octants(level) {
    const count = 2 ** level;
    const size = side / count;
    const words = new Uint32Array(11 * count ** 3);
    const floats = new Float32Array(words.buffer);
    for (let k = 0; k < count ** 3; ++k) {
      const at = [k % count, Math.floor(k / count) % count, Math.floor(k / count ** 2)];
      for (let axis = 0; axis < 3; ++axis) {
        floats[11 * k + axis] = at[axis] * size;
        floats[11 * k + axis + 3] = (at[axis] + 1) * size;
      }
      const key = BigInt(octalKey(...at, level)) << BigInt(63 - 3 * level);
      words.set([1 + k % 97, k % 5, level === 3 ? 1 : 0, Number(key >> 32n), Number(key & 0xffffffffn)], 11 * k + 6);
    }
    return bytesOf(words);
  }

  near(f, query) {
    const {boxes} = this.frame(f);
    const counts = this.partnerCounts(f);
    const corner = name => query.get(name).split(',').map((value, axis) => Number(value) - 1000 * (axis + 1));
    const [low, high] = [corner('min'), corner('max')];
    const found = [];
    for (let k = 0; k < this.n; ++k) {
      if (k % 4 && [0, 1, 2].every(axis => boxes[6 * k + axis] <= high[axis] && boxes[6 * k + axis + 3] >= low[axis])) found.push(k);
    }
    const kept = found.slice(0, 100000);
    const some = Float32Array.from(kept.flatMap(k => [...boxes.subarray(6 * k, 6 * k + 6)]));
    return Buffer.concat([Buffer.from(Uint32Array.of(found.length, kept.length, ...kept).buffer), bytesOf(some),
      Buffer.from(Uint32Array.from(kept, k => counts[k]).buffer)]);
  }

  poses(f) {
    const {boxes} = this.frame(f);
    const poses = new Float32Array(12 * this.n);
    for (let k = 0; k < this.n; ++k) {
      for (let axis = 0; axis < 3; ++axis) {
        poses[12 * k + 4 * axis] = 0.5 * (boxes[6 * k + axis + 3] - boxes[6 * k + axis]);
        poses[12 * k + 9 + axis] = 0.5 * (boxes[6 * k + axis + 3] + boxes[6 * k + axis]);
      }
    }
    return bytesOf(poses);
  }

  search(text) {
    const found = [];
    for (let k = 0; k < this.n; ++k) {
      const name = this.names?.[k] ?? '';
      if (String(k) === text || name.toLowerCase().includes(text.toLowerCase())) found.push({index: k, name});
    }
    return {total: found.length, found: found.slice(0, 50)};
  }

  timeline() {
    const frames = Array.from({length: this.frames}, (_, f) => f);
    return {frames: this.frames, done: this.frames, pairs: frames.map(f => this.frame(f).pairs.length),
      began: frames.map(f => this.changes(f).began.length), ended: frames.map(f => this.changes(f).ended.length)};
  }

  answer(address, query) {
    const [name, second = '', third = ''] = address.split('/');
    const f = Number.parseInt(second, 10);
    const shape = this.shapes?.[f];
    switch (address.replace(/\d+/g, '0')) {
      case 'view.json': return this.view();
      case 'shown.u0': return this.shown ? bytesOf(this.shown) : null;
      case 'groups.u0': return bytesOf(Uint32Array.from({length: this.rows}, (_, row) => 1 << this.objectAt(row) % 3));
      case 'names.json': return this.names && this.ofRows(this.names, 1);
      case 'details.json': return this.details();
      case 'geometry.u0': return bytesOf(Uint32Array.from({length: this.rows}, (_, row) => row % 3));
      case 'shapes.json': return {shapes: this.shapes.map(s => ({kind: 'mesh', vertices: s.vertices.length / 3, triangles: s.triangles.length / 3}))};
      case 'shape/0': return shape ? Buffer.concat([bytesOf(Float32Array.from(shape.vertices)), bytesOf(Uint32Array.from(shape.triangles))]) : null;
      case 'timeline.json': return this.timeline();
      case 'search.json': return this.search(query.get('q') ?? '');
      default: return f < this.frames ? this.frameAnswer(name, f, Number.parseInt(third, 10), address.endsWith('.f32'), query) : null;
    }
  }

  frameAnswer(name, f, third, binary, query) {
    const {boxes, pairs} = this.frame(f);
    switch (name) {
      case 'frame': return binary ? bytesOf(this.ofRows(boxes, 6)) : {frame: f, pairs: pairs.length, pairs_listed: pairs.length,
        began: this.changes(f).began.length, ended: this.changes(f).ended.length, classes: this.classCounts(f), seconds: {detect: 0.001}};
      case 'poses': return this.poses(f);
      case 'partners': return bytesOf(this.ofRows(this.partnerCounts(f), 1));
      case 'classes': return this.n <= 20000 ? bytesOf(Uint8Array.from(this.ofRows(this.worstClasses(f), 1))) : null;
      case 'levels': return bytesOf(Uint8Array.from({length: this.rows}, (_, row) => this.level(this.objectAt(row))));
      case 'pairs': return flat(pairs);
      case 'began': return flat(this.changes(f).began);
      case 'ended': return flat(this.changes(f).ended);
      case 'octants': return Number.isNaN(third) ? {entries: this.n, levels: [0, 1, 2, 3].map(level => ({octants: 8 ** level, leaves: level === 3 ? 512 : 0,
        listed: 8 ** level}))} : this.octants(third);
      case 'collisions': return this.collisions(f, query);
      case 'object': return this.object(f, third);
      case 'near': return this.near(f, query);
      default: return null;
    }
  }
}

// A live scene: a tenth of the objects moves in each step.
class LiveScene extends StaticScene {
  constructor(n) {
    super('live', n);
    this.history = [];
    this.now = -1;
    this.waiting = [];
    this.step();
    this.timer = setInterval(() => this.step(), 100);
  }

  stop() {
    clearInterval(this.timer);
  }

  step() {
    const boxes = this.now < 0 ? boxesAt(this.list, 0) : this.state.boxes.slice();
    this.now += 1;
    const next = boxesAt(this.list, this.now);
    if (this.now > 0) for (let k = this.now % 10; k < this.n; k += 10) boxes.set(next.subarray(6 * k, 6 * k + 6), 6 * k);
    this.state = {boxes, pairs: findPairs(boxes)};
    this.history[this.now] = this.state;
    delete this.history[this.now - 50];
    for (const give of this.waiting.splice(0)) give();
  }

  frame() {
    return this.state ?? {boxes: boxesAt(this.list, 0), pairs: []};
  }

  changes() {
    return {began: [], ended: []};
  }

  view() {
    return {...super.view(), kind: 'live', has: {...super.view().has, names: false, groups: false, events: true, contacts: false, classes: false, details: false}};
  }

  receive(message, send) {
    const give = () => send(this.liveFrame(message.want));
    if (message.want < this.now) give();
    else this.waiting.push(give);
  }

  liveFrame(base) {
    const {boxes, pairs} = this.state;
    const old = this.history[base];
    const head = new Uint32Array(16);
    head.set([0x4f504c56, this.now, old ? base : 0xffffffff, this.n, this.n]);
    head.set([pairs.length, 0, pairs.length, 1234, this.n], 8);
    if (!old) return Buffer.concat([bytesOf(head), bytesOf(boxes), flat(pairs)]);
    const moved = [...Array(this.n).keys()].filter(k => [0, 1, 2, 3, 4, 5].some(c => old.boxes[6 * k + c] !== boxes[6 * k + c]));
    const [now, before] = [new Set(pairs.map(String)), new Set(old.pairs.map(String))];
    const began = pairs.filter(pair => !before.has(String(pair)));
    const ended = old.pairs.filter(pair => !now.has(String(pair)));
    head.set([moved.length, began.length, ended.length], 5);
    return Buffer.concat([bytesOf(head), bytesOf(Uint32Array.from(moved)),
      bytesOf(Float32Array.from(moved.flatMap(k => [...boxes.subarray(6 * k, 6 * k + 6)]))), flat(began), flat(ended)]);
  }

  answer(address, query) {
    if (/^(frame|pairs|partners|levels|timeline)/.test(address)) return null;
    return super.answer(address.replace(/^(\w+\/)\d+/, '$10'), query);
  }
}

class ServerScene {
  ready() {
    return true;
  }

  answer(address) {
    return address === 'view.json' ? {version: '0.2.0', title: 'server', kind: 'server'} : null;
  }

  connect(send) {
    send({event: 'ready'});
    this.send = send;
    let progress = 0.3;
    const report = () => {
      if (this.silent) return;
      progress = Math.min(1, progress + 0.05);
      const job = {owner: 'anna', queued_before: 0, count_only: false, error: '', progress: 0, pairs: 0, objects: 1000};
      send({event: 'jobs', jobs: [{...job, id: 'job-1', state: 'running', progress}, {...job, id: 'job-2', state: 'queued', queued_before: 1, count_only: true},
        {...job, id: 'job-3', state: 'failed', error: 'the input has no boxes'}],
      scenes: [{id: 'crane 7', owner: 'ben', objects: 5000, pairs: 31, steps: 17, step_seconds: 0.0013}]});
    };
    report();
    const timer = setInterval(report, 500);
    return () => clearInterval(timer);
  }
}

export function makeScene(kind, objects) {
  if (kind === 'live') return new LiveScene(objects);
  return kind === 'server' ? new ServerScene() : new StaticScene(kind, objects);
}
