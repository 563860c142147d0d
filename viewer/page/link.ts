// The part of the address after # holds the view: camera, frame, selection and the settings that differ from the start.
import {copyText, later} from './dom.ts';
import type {Name, Settings} from './settings.ts';

export interface LinkParts {
  camera: string;
  frame: number;
  selected: readonly number[];
}

export interface LinkState {
  camera: string | null;
  frame: number | null;
  selected: number[];
  // The address has no link.
  empty: boolean;
}

// Reads the link and sets the settings that it holds.
export function readLink(settings: Settings): LinkState {
  const parameters = new URLSearchParams(location.hash.slice(1));
  for (const name of Object.keys(settings.values) as Name[]) {
    const text = parameters.get(name);
    if (text !== null) settings.read(name, text);
  }
  const frame = parameters.get('frame');
  const selected = (parameters.get('selected') ?? '').split(',').filter(text => /^\d+$/.test(text)).map(Number);
  const number = frame !== null && /^\d+$/.test(frame) ? Number(frame) : null;
  return {empty: location.hash.length < 2, camera: parameters.get('at'), frame: number, selected};
}

function linkText(settings: Settings, parts: LinkParts): string {
  const parameters = new URLSearchParams();
  parameters.set('at', parts.camera);
  if (parts.frame > 0) parameters.set('frame', String(parts.frame));
  if (parts.selected.length) parameters.set('selected', parts.selected.join(','));
  for (const name of Object.keys(settings.values) as Name[]) {
    const value = settings.values[name];
    if (value === settings.start[name]) continue;
    parameters.set(name, typeof value === 'boolean' ? (value ? '1' : '0') : String(value));
  }
  return `#${parameters}`;
}

export class Link {
  readonly changed = later(() => this.write(), 250);

  constructor(private readonly settings: Settings, private readonly parts: () => LinkParts) {}

  write(): void {
    try {
      history.replaceState(null, '', linkText(this.settings, this.parts()));
    } catch {
      // A page within another document may not change its address.
    }
  }

  async copy(): Promise<boolean> {
    this.write();
    const address = new URL(location.href);
    // A token is for one browser; it is no part of a view.
    address.searchParams.delete('token');
    return copyText(address.href);
  }
}
