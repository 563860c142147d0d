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
  let first = true;
  window.addEventListener('message', event => {
    const objects: unknown = event.data?.select;
    if (event.source !== window.parent || !Array.isArray(objects)) return;
    // A report that begins without a chosen row leaves the worst collision selected.
    if (objects.length === 0 && !first) void app.clearSelection();
    first = false;
    if (objects.length) void app.openAll(objects.filter(object => typeof object === 'number'));
  });
  tellReport('ready');
}
