// octopair-ifc: reads IFC2x3, IFC4 and IFC4x3 (.ifc, .ifczip) by web-ifc, and writes a model stream.
//
//     octopair-ifc [--include-type TYPE]... FILE
import {readFileSync} from 'node:fs';
import {inflateRawSync} from 'node:zlib';

import {Relations} from './relations.mjs';
import {Shapes} from './shapes.mjs';
import {StreamWriter} from './stream_writer.mjs';
import {ifc} from './web_ifc.mjs';

// These types have a shape, but their elements are no solid things.
const leftOut = new Set(['IfcSpace', 'IfcSpatialZone', 'IfcOpeningElement', 'IfcOpeningStandardCase', 'IfcVirtualElement', 'IfcAnnotation',
  'IfcGrid', 'IfcDistributionPort', 'IfcStructuralCurveMember', 'IfcStructuralSurfaceMember', 'IfcStructuralPointConnection',
  'IfcStructuralCurveConnection', 'IfcStructuralSurfaceConnection', 'IfcStructuralPointAction', 'IfcStructuralCurveAction',
  'IfcStructuralLinearAction', 'IfcStructuralSurfaceAction', 'IfcStructuralPlanarAction', 'IfcStructuralPointReaction']);

function parseArguments(words) {
  const wanted = {types: new Set(), file: null};
  for (let i = 0; i < words.length; ++i) {
    if (words[i] === '--include-type' && i + 1 < words.length) wanted.types.add(words[++i].toLowerCase());
    else if (wanted.file === null) wanted.file = words[i];
    else throw new Error(`one file, not also ${words[i]}`);
  }
  if (wanted.file === null) throw new Error('octopair-ifc [--include-type TYPE]... FILE');
  return wanted;
}

// The IFC text in an archive: its only file with the ending .ifc.
function unzip(bytes) {
  const end = bytes.lastIndexOf(Buffer.from('PK\x05\x06', 'latin1'));
  if (end < 0) throw new Error('the archive has no directory: it is cut');
  let at = bytes.readUInt32LE(end + 16);
  for (let left = bytes.readUInt16LE(end + 10); left > 0; --left) {
    const name = bytes.toString('utf8', at + 46, at + 46 + bytes.readUInt16LE(at + 28));
    if (name.toLowerCase().endsWith('.ifc')) {
      const start = bytes.readUInt32LE(at + 42);
      const data = start + 30 + bytes.readUInt16LE(start + 26) + bytes.readUInt16LE(start + 28);
      const packed = bytes.subarray(data, data + bytes.readUInt32LE(at + 20));
      return bytes.readUInt16LE(at + 10) === 0 ? packed : inflateRawSync(packed);
    }
    at += 46 + bytes.readUInt16LE(at + 28) + bytes.readUInt16LE(at + 30) + bytes.readUInt16LE(at + 32);
  }
  throw new Error('the archive has no .ifc file');
}

function readText(file) {
  const bytes = readFileSync(file);
  return bytes.length > 4 && bytes.toString('latin1', 0, 4) === 'PK\x03\x04' ? unzip(bytes) : bytes;
}

// Bodies, not axes, footprints or boxes, are what collides. Beside a 'Body', other representations show the same body in another way.
const noBodies = new Set(['Axis', 'FootPrint', 'Box', 'Annotation', 'Profile', 'CoG', 'Reference', 'Plan', 'Clearance', 'Lighting']);

// Whether a product has a body: true, false, or null if its representation cannot be read. Removes what is no body, because web-ifc would
// take it for one.
function findBody(api, model, relations, product) {
  const shape = product.Representation?.value;
  if (shape === undefined) return false;
  const parts = relations.line(shape)?.Representations;
  if (!parts) return null;
  const kind = part => relations.text(part.value, 'RepresentationIdentifier');
  const named = parts.filter(part => kind(part) === 'Body');
  const bodies = named.length > 0 ? named : parts.filter(part => !noBodies.has(kind(part)));
  if (bodies.length > 0 && bodies.length < parts.length) api.WriteLine(model, {...relations.line(shape), Representations: bodies});
  return bodies.length > 0;
}

class Counts {
  constructor() {
    this.byType = new Map();
  }
  add(type, first = '') {
    if (!this.byType.has(type)) this.byType.set(type, {type, count: 0, first});
    this.byType.get(type).count++;
  }
  list() {
    return [...this.byType.values()];
  }
}

async function main(words) {
  const {types, file} = parseArguments(words);
  const writer = new StreamWriter();
  const text = readText(file);
  if (text.lastIndexOf('END-ISO-10303-21') < text.lastIndexOf('ENDSEC'))
    return writer.failure('is cut: an IFC file ends with END-ISO-10303-21;');
  const api = new ifc.IfcAPI();
  await api.Init();
  api.SetLogLevel(ifc.LogLevel.LOG_LEVEL_OFF);
  const model = api.OpenModel(text, {COORDINATE_TO_ORIGIN: false, CIRCLE_SEGMENTS: 24});
  if (model < 0 || !api.GetModelSchema(model)) return writer.failure('has a schema that web-ifc does not read; it reads IFC2x3, IFC4 and IFC4x3');
  const relations = new Relations(api, model);
  const projects = api.GetLineIDsWithType(model, ifc.IFCPROJECT, true);
  writer.model({unit: 'm', up: 'z', project: projects.size() > 0 ? relations.globalId(projects.get(0)) : ''});

  for (const type of types) {
    if (![...leftOut].some(known => known.toLowerCase() === type)) writer.warning(`--include-type ${type}: no such type is left out`);
  }
  const shapes = new Shapes(api, model, writer);
  const lost = new Counts(), out = new Counts();
  let withGeometry = 0, read = 0;
  const products = api.GetLineIDsWithType(model, ifc.IFCPRODUCT, true);
  for (let i = 0; i < products.size(); ++i) {
    const id = products.get(i);
    const type = relations.typeName(id);
    const product = relations.line(id);
    const body = product ? findBody(api, model, relations, product) : null;
    if (body === false) continue;
    if (leftOut.has(type) && !types.has(type.toLowerCase())) {
      out.add(type.toUpperCase());
      continue;
    }
    const described = product ? relations.describe(id) : {id: `#${id}`, label: ''};
    const named = `${described.id} ('${described.label}')`;
    writer.element(`${type} ${named}`);
    ++withGeometry;
    const placed = body ? shapes.of(id) : null;
    if (placed) {
      ++read;
      writer.instance({...described, ...placed});
    } else {
      lost.add(type.toUpperCase(), named);
    }
  }
  writer.end({withGeometry, read, lost: lost.list(), leftOut: out.list()});
}

main(process.argv.slice(2)).catch(error => {
  console.error(String(error?.message ?? error));
  process.exit(1);
});
