// The page on paper: in light colours, with the present picture and the rows that are listed. A browser does not print what a canvas drew before.
import type {App} from './app.ts';
import {byId} from './dom.ts';

export function startPrinting(app: App): void {
  const picture = byId<HTMLImageElement>('printed');
  const {settings, stage} = app;
  let {theme} = settings.values;
  window.addEventListener('beforeprint', () => {
    theme = settings.values.theme;
    settings.set('theme', 'light');
    stage.drawNow();
    picture.src = stage.canvas.toDataURL();
    picture.hidden = false;
  });
  window.addEventListener('afterprint', () => {
    picture.hidden = true;
    settings.set('theme', theme);
  });
}
