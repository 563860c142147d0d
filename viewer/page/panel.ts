// The header's counts, the summary and the notices of the scene, the progress bar and messages.
import {byId, count, counted, definitions, make, plain, seconds} from './dom.ts';
import type {LegendEntry} from './colours.ts';
import {css} from './colours.ts';
import type {SceneModel} from './scene_model.ts';

export function showProgress(text: string, done: number | null): void {
  if (document.documentElement.dataset.failed) return;
  byId('loading').hidden = false;
  byId('loading-text').textContent = text;
  const bar = byId<HTMLProgressElement>('loading-bar');
  if (done === null) bar.removeAttribute('value');
  else bar.value = done;
}

export function hideProgress(): void {
  byId('loading').hidden = true;
}

export function showFailure(message: string): void {
  hideProgress();
  showBanner('');
  document.documentElement.dataset.side = 'closed';
  byId('failure').hidden = false;
  byId('failure-text').textContent = message;
  document.documentElement.dataset.failed = 'true';
  if (byId('viewer').hidden) showBanner(message);
}

// A line above the page that stays, for scenes and servers. An empty text removes it.
export function showBanner(text: string): void {
  const banner = byId('banner');
  if (banner.textContent !== text) banner.textContent = text;
  banner.hidden = text === '';
}

let messageTimer = 0;

// A short message that screen readers read out.
export function say(message: string): void {
  byId('message').textContent = message;
  clearTimeout(messageTimer);
  messageTimer = window.setTimeout(() => byId('message').textContent = '', 6000);
}

// A message for screen readers alone, if the page shows the same elsewhere.
export function speak(message: string): void {
  byId('spoken').textContent = message;
}

export function showTitle(model: SceneModel): void {
  const {view, frame} = model;
  byId('title').textContent = view.title || 'scene';
  document.title = view.title ? `${view.title} – octopair` : 'octopair';
  const {pairs, began = 0, ended = 0, classes} = frame.info;
  const events = view.has.events || view.kind === 'live' ? `, ${count(began)} began, ${count(ended)} ended` : '';
  byId('counts').textContent = `${counted(frame.info.objects ?? view.objects, 'object', 'objects')}, ${counted(pairs, ...(classes ? ['collision', 'collisions'] : ['pair', 'pairs']) as [string, string])}${events}`;
}

export function showSummary(model: SceneModel): void {
  const {view, frame} = model;
  const entries: [string, string][] = [['objects', count(view.objects)]];
  if (view.shown < view.objects) entries.push(['in the overview', count(view.shown)]);
  if (view.frames > 1) entries.push(['frames', count(view.frames)]);
  if (view.margin) entries.push(['margin', plain(view.margin)]);
  if (view.unit) entries.push(['unit', view.unit]);
  for (const [name, value] of Object.entries(view.summary)) {
    if (!['seconds', 'objects', 'pairs'].includes(name)) entries.push([words(name), plain(value)]);
  }
  for (const {name, first} of view.files) entries.push(['file', `${name}, from object ${count(first)}`]);
  byId('summary').replaceChildren(definitions(entries));
  const {classes, seconds: _, pairs, pairs_listed: listed = pairs, frame: number, objects, began, ended, ...numbers} = frame.info;
  const moves = view.frames > 1 || view.has.events || view.kind === 'live';
  const info = {...(moves ? {frame: number, objects, began, ended} : {}), [classes ? 'collisions' : 'pairs']: pairs,
    ...(listed < pairs ? {listed} : {}), ...classes, ...numbers};
  byId('frame-title').textContent = moves ? 'Frame' : 'Result';
  byId('frame-info').replaceChildren(definitions(Object.entries(info).filter(([, value]) => value !== undefined)
    .map(([name, value]) => [words(name), plain(value)])));
  showSeconds({...view.summary.seconds as Record<string, number> | undefined, ...frame.info.seconds});
}

function showSeconds(times: Record<string, number>): void {
  const rows = Object.entries(times).filter(([, value]) => typeof value === 'number').map(([name, value]) => {
    const row = make('tr');
    row.append(make('td', words(name)), make('td', seconds(value), 'number'));
    return row;
  });
  byId('seconds-rows').replaceChildren(...rows);
  byId('seconds').hidden = rows.length === 0;
}

export function showNotices(notices: readonly string[]): void {
  const host = byId('notices');
  const texts = notices.filter(text => text);
  host.hidden = texts.length === 0;
  const old = [...host.children].map(child => child.textContent);
  if (old.join('\n') !== texts.join('\n')) host.replaceChildren(...texts.map(text => make('p', text)));
}

export function showLegend(entries: readonly LegendEntry[]): void {
  byId('legend').replaceChildren(...entries.map(entry => {
    const item = make('li', entry.text);
    const swatch = make('span', entry.mark ?? '', entry.mark ? 'mark' : 'swatch');
    swatch.style[entry.mark ? 'color' : 'background'] = css(entry.colour);
    item.prepend(swatch);
    return item;
  }));
}

function words(name: string): string {
  return name.replace(/_/g, ' ');
}
