// A page within a report: selects what the report chooses.
import type {App} from './app.ts';
import {setOpen} from './layout.ts';

export function tellReport(state: 'ready' | 'failed'): void {
  if (window.parent !== window) window.parent.postMessage({viewer: state}, '*');
}

export function startWithin(app: App): void {
  if (window.parent === window) return;
  // The report has a table of its own.
  setOpen('side', false);
  window.addEventListener('message', event => {
    const objects: unknown = event.data?.select;
    if (event.source !== window.parent || !Array.isArray(objects)) return;
    void app.selection.select(objects.filter(object => typeof object === 'number')).then(() => app.zoomToSelection());
  });
  tellReport('ready');
}
