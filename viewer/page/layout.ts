// Panels that open and close, the tabs, and the theme of the page.
import {byId} from './dom.ts';
import type {Settings} from './settings.ts';

type Drawer = 'options' | 'side';

const narrow = window.matchMedia('(max-width: 760px)');
const prefersDark = window.matchMedia('(prefers-color-scheme: dark)');

export function isOpen(drawer: Drawer): boolean {
  return document.documentElement.dataset[drawer] !== 'closed';
}

export function setOpen(drawer: Drawer, open: boolean): void {
  document.documentElement.dataset[drawer] = open ? 'open' : 'closed';
  byId(`toggle-${drawer}`).setAttribute('aria-expanded', String(open));
  // A phone has room for one drawer.
  const other = drawer === 'side' ? 'options' : 'side';
  if (open && narrow.matches && isOpen(other)) setOpen(other, false);
}

export function toggleOpen(drawer: Drawer): void {
  setOpen(drawer, !isOpen(drawer));
}

// The edge of the side panel follows the pointer, and the arrow keys.
function startSideEdge(): void {
  const edge = byId('side-edge');
  const resize = (width: number): void => {
    const allowed = Math.round(Math.min(Math.max(width, 280), 800, Math.max(0.6 * window.innerWidth, 280)));
    document.documentElement.style.setProperty('--side', `${allowed}px`);
    edge.setAttribute('aria-valuenow', String(allowed));
  };
  edge.setAttribute('aria-valuenow', String(byId('side').offsetWidth));
  edge.addEventListener('pointerdown', event => edge.setPointerCapture(event.pointerId));
  edge.addEventListener('pointermove', event => edge.hasPointerCapture(event.pointerId) && resize(window.innerWidth - event.clientX));
  edge.addEventListener('keydown', event => {
    if (event.key !== 'ArrowLeft' && event.key !== 'ArrowRight') return;
    resize(byId('side').offsetWidth + (event.key === 'ArrowLeft' ? 20 : -20));
    event.preventDefault();
  });
}

// `changed` is called when panels opened or closed.
export function startLayout(changed: () => void): void {
  for (const drawer of ['options', 'side'] as const) {
    // The settings would cover a part of the first picture.
    setOpen(drawer, drawer === 'side' && !narrow.matches);
    byId(`toggle-${drawer}`).addEventListener('click', () => toggleOpen(drawer));
    new MutationObserver(changed).observe(document.documentElement, {attributeFilter: [`data-${drawer}`]});
  }
  startSideEdge();
  const tabs = [byId('tab-collisions'), byId('tab-scene')];
  for (const tab of tabs) {
    tab.addEventListener('click', () => showTab(tab.id));
    tab.addEventListener('keydown', event => {
      if (event.key !== 'ArrowLeft' && event.key !== 'ArrowRight') return;
      const other = tabs[tab === tabs[0] ? 1 : 0]!;
      showTab(other.id);
      other.focus();
    });
  }
}

export function showTab(id: string): void {
  for (const tab of [byId('tab-collisions'), byId('tab-scene')]) {
    const chosen = tab.id === id;
    tab.setAttribute('aria-selected', String(chosen));
    tab.tabIndex = chosen ? 0 : -1;
    byId(tab.getAttribute('aria-controls')!).hidden = !chosen;
  }
}

export function isDark(settings: Settings): boolean {
  const {theme} = settings.values;
  return theme === 'dark' || (theme === 'system' && prefersDark.matches);
}

export function applyTheme(settings: Settings): void {
  document.documentElement.dataset.theme = isDark(settings) ? 'dark' : 'light';
}

export function startTheme(settings: Settings): void {
  applyTheme(settings);
  prefersDark.addEventListener('change', () => settings.changed('theme'));
}

// From light to dark or back, whatever the system prefers.
export function switchTheme(settings: Settings): void {
  settings.set('theme', isDark(settings) ? 'light' : 'dark');
}
