// Small helpers for elements. Texts are always set as text, since names in a scene are not to be trusted.

export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element ${id}`);
  return element as T;
}

export function make<K extends keyof HTMLElementTagNameMap>(tag: K, text = '', className = ''): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (text) element.textContent = text;
  if (className) element.className = className;
  return element;
}

export function button(text: string, action: () => void, label = ''): HTMLButtonElement {
  const element = make('button', text);
  element.type = 'button';
  if (label) element.setAttribute('aria-label', label);
  element.addEventListener('click', action);
  return element;
}

export function count(value: number): string {
  return Math.round(value).toLocaleString('en-US');
}

export function counted(value: number, one: string, many: string): string {
  return `${count(value)} ${value === 1 ? one : many}`;
}

// A number with the digits that matter.
export function short(value: number): string {
  if (Number.isInteger(value) && Math.abs(value) < 1e15) return value.toLocaleString('en-US');
  return String(Number(value.toPrecision(5)));
}

// A measured number with four digits, such as a depth.
export function significant(value: number): string {
  const rounded = Number(value.toPrecision(4));
  const size = Math.abs(rounded);
  return size !== 0 && (size < 1e-4 || size >= 1e7) ? rounded.toExponential() : rounded.toLocaleString('en-US', {maximumFractionDigits: 8});
}

// The last parts of a path such as "hull/deck/plate", which tell objects apart.
export function tail(name: string, parts = 1): string {
  let at = name.length - 1;
  for (let k = 0; k < parts && at > 0; ++k) at = name.lastIndexOf('/', at - 1);
  return name.slice(Math.max(at, -1) + 1);
}

// Paths of objects end with the object itself; what is before is its parent.
export function pathBefore(name: string): string {
  return name.slice(0, Math.max(0, name.lastIndexOf('/')));
}

export function seconds(value: number): string {
  if (value < 1e-3) return `${short(Number((value * 1e6).toPrecision(3)))} µs`;
  if (value < 1) return `${short(Number((value * 1e3).toPrecision(3)))} ms`;
  return `${short(Number(value.toPrecision(3)))} s`;
}

// A list of terms and their texts.
export function definitions(entries: readonly (readonly [string, string])[]): HTMLDListElement {
  const list = make('dl');
  for (const [term, text] of entries) list.append(make('dt', term), make('dd', text));
  return list;
}

// Any value of JSON as a short text.
export function plain(value: unknown): string {
  if (typeof value === 'number') return short(value);
  if (typeof value === 'string') return value;
  if (Array.isArray(value)) return value.map(plain).join(', ');
  return JSON.stringify(value) ?? '';
}

export async function copyText(text: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return copyOldWay(text);
  }
}

// For pages that may not use the clipboard, such as a file.
function copyOldWay(text: string): boolean {
  const field = document.createElement('textarea');
  field.value = text;
  field.setAttribute('aria-label', 'Copied text');
  document.body.append(field);
  field.select();
  const copied = document.execCommand('copy');
  field.remove();
  return copied;
}

export function later(action: () => void, milliseconds: number): () => void {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = window.setTimeout(action, milliseconds);
  };
}

export function isAbort(error: unknown): boolean {
  return error instanceof DOMException && error.name === 'AbortError';
}

export function messageOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
