// The page on paper: in light colours, with the present picture and the rows that are listed. A browser does not print what a canvas drew before.
import type {App} from './app.ts';
import {make} from './dom.ts';

export function startPrinting({settings, stage}: App): void {
  const picture = make('img', '', 'printed');
  picture.alt = 'The picture of the selection';
  let {theme} = settings.values;
  window.addEventListener('beforeprint', () => {
    theme = settings.values.theme;
    settings.set('theme', 'light');
    stage.drawNow();
    picture.src = stage.canvas.toDataURL();
    stage.canvas.after(picture);
  });
  window.addEventListener('afterprint', () => {
    picture.remove();
    settings.set('theme', theme);
  });
}
