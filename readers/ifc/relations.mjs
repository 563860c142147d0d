// Relations reads the names, places and relations of the elements of an IFC file.
import {ifc} from './web_ifc.mjs';

const refs = value => (Array.isArray(value) ? value : value ? [value] : []).map(item => item?.value).filter(item => typeof item === 'number');

export class Relations {
  constructor(api, model) {
    this.api = api;
    this.model = model;
    this.lines = new Map();
    this.containers = new Map();  // of elements: what contains them, in space or as a whole
    this.wholes = new Map();
    this.hosts = new Map();
    this.systems = new Map();
    this.materials = new Map();  // of elements and of their types
    this.types = new Map();
    this.readSpace();
    this.readOpenings();
    this.readSystems();
    this.readMaterials();
    this.readTypes();
  }

  line(id) {
    let line = this.lines.get(id);
    if (line === undefined) {
      try {
        line = this.api.GetLine(this.model, id) ?? null;
      } catch {
        line = null;
      }
      this.lines.set(id, line);
    }
    return line;
  }

  text(id, attribute) {
    const value = this.line(id)?.[attribute]?.value;
    return typeof value === 'string' ? value : '';
  }

  globalId(id) {
    return this.text(id, 'GlobalId');
  }

  typeName(id) {
    return this.api.GetNameFromTypeCode(this.api.GetLineType(this.model, id));
  }

  all(type, visit) {
    const ids = this.api.GetLineIDsWithType(this.model, type, true);
    for (let i = 0; i < ids.size(); ++i) {
      const line = this.line(ids.get(i));
      if (line) visit(line);
    }
  }

  isPlace(id) {
    const type = this.typeName(id);
    return ['IfcProject', 'IfcSite', 'IfcBuilding', 'IfcBuildingStorey', 'IfcSpace', 'IfcFacility', 'IfcFacilityPart'].includes(type) ||
      this.line(id)?.CompositionType !== undefined;
  }

  readSpace() {
    this.all(ifc.IFCRELCONTAINEDINSPATIALSTRUCTURE, line => {
      for (const part of refs(line.RelatedElements)) this.containers.set(part, line.RelatingStructure?.value);
    });
    this.all(ifc.IFCRELAGGREGATES, line => {
      const whole = line.RelatingObject?.value;
      for (const part of refs(line.RelatedObjects)) {
        this.containers.set(part, whole);
        if (!this.isPlace(whole)) this.wholes.set(part, whole);
      }
    });
  }

  readOpenings() {
    const walls = new Map();  // by their openings
    this.all(ifc.IFCRELVOIDSELEMENT, line => walls.set(line.RelatedOpeningElement?.value, line.RelatingBuildingElement?.value));
    this.all(ifc.IFCRELFILLSELEMENT, line => {
      const wall = walls.get(line.RelatingOpeningElement?.value);
      if (wall !== undefined) this.hosts.set(line.RelatedBuildingElement?.value, wall);
    });
  }

  readSystems() {
    const isSystem = group => ['IfcSystem', 'IfcBuildingSystem', 'IfcBuiltSystem', 'IfcDistributionSystem', 'IfcDistributionCircuit',
      'IfcElectricalCircuit', 'IfcStructuralAnalysisModel'].includes(this.typeName(group));
    this.all(ifc.IFCRELASSIGNSTOGROUP, line => {
      const group = line.RelatingGroup?.value;
      if (group === undefined || !isSystem(group)) return;
      for (const member of refs(line.RelatedObjects)) {
        if (!this.systems.has(member)) this.systems.set(member, []);
        this.systems.get(member).push(this.globalId(group));
      }
    });
  }

  readMaterials() {
    this.all(ifc.IFCRELASSOCIATESMATERIAL, line => {
      const names = [...new Set(this.materialNames(line.RelatingMaterial?.value, 0))].sort();
      const text = names.length > 8 ? [...names.slice(0, 8), '...'].join(', ') : names.join(', ');
      for (const element of refs(line.RelatedObjects)) this.materials.set(element, text);
    });
  }

  readTypes() {
    this.all(ifc.IFCRELDEFINESBYTYPE, line => {
      for (const element of refs(line.RelatedObjects)) this.types.set(element, line.RelatingType?.value);
    });
  }

  // Names of the materials that a material, a list, a set of layers, profiles or constituents, or a use of one has.
  materialNames(id, depth) {
    const line = id === undefined ? null : this.line(id);
    if (!line || depth > 4) return [];
    if (this.typeName(id) === 'IfcMaterial') return line.Name?.value ? [line.Name.value] : [];
    const members = ['Materials', 'MaterialLayers', 'MaterialProfiles', 'MaterialConstituents', 'Material', 'ForLayerSet', 'ForProfileSet'];
    return members.flatMap(member => refs(line[member])).flatMap(ref => this.materialNames(ref, depth + 1));
  }

  // Returns what contains an element, from the project down.
  above(id) {
    const path = [];
    for (let at = this.containers.get(id); at !== undefined && !path.includes(at); at = this.containers.get(at)) path.unshift(at);
    return path;
  }

  labelOf(id) {
    return this.text(id, 'Name') || this.typeName(id);
  }

  // The names of an element in a stream.
  describe(id) {
    const above = this.above(id);
    const level = above.filter(place => this.typeName(place) === 'IfcBuildingStorey').pop();
    const segment = part => `${this.typeName(part)}_${this.text(part, 'Name')}_${this.globalId(part)}`.replaceAll('/', '|');
    const whole = this.wholes.get(id);
    const host = this.hosts.get(id);
    return {
      name: [...above, id].map(segment).join('/'), label: this.labelOf(id), type: this.typeName(id), id: this.globalId(id),
      parent: above.length > 0 ? this.labelOf(above[above.length - 1]) : '', level: level === undefined ? '' : this.text(level, 'Name'),
      material: this.materials.get(id) ?? this.materials.get(this.types.get(id)) ?? '', host: host === undefined ? '' : this.globalId(host),
      assembly: whole === undefined ? '' : this.globalId(whole), systems: this.systems.get(id) ?? [],
    };
  }
}
