// The page of a server: its jobs and its scenes.
import {byId, count, make, seconds} from './dom.ts';
import type {Job, ServedScene} from './types.ts';

export function showServer(jobs: readonly Job[], scenes: readonly ServedScene[]): void {
  byId('server').hidden = false;
  byId('viewer').hidden = true;
  byId('no-jobs').hidden = jobs.length > 0;
  byId('no-scenes').hidden = scenes.length > 0;
  byId('jobs').hidden = jobs.length === 0;
  byId('scenes').hidden = scenes.length === 0;
  byId('job-rows').replaceChildren(...jobs.map(jobRow));
  byId('scene-rows').replaceChildren(...scenes.map(sceneRow));
  document.documentElement.dataset.jobs = String(jobs.length);
  document.documentElement.dataset.scenes = String(scenes.length);
  document.documentElement.dataset.ready = 'true';
}

function jobRow(job: Job): HTMLElement {
  const row = make('tr');
  row.append(make('td', job.id), make('td', job.owner || 'no name'), stateCell(job), make('td', count(job.objects), 'number'),
    make('td', job.state === 'done' || job.pairs > 0 ? count(job.pairs) : '', 'number'));
  return row;
}

function stateCell(job: Job): HTMLElement {
  const cell = make('td');
  const texts = [job.state];
  if (job.queued_before > 0) texts.push(`${count(job.queued_before)} before it`);
  if (job.count_only) texts.push('count only');
  if (job.error) texts.push(job.error);
  cell.append(make('span', texts.join(', '), job.error ? 'bad' : ''));
  if (job.state === 'running') {
    const bar = make('progress');
    bar.value = Math.min(Math.max(job.progress, 0), 1);
    bar.setAttribute('aria-label', `Progress of job ${job.id}`);
    cell.append(bar);
  }
  return cell;
}

function sceneRow(scene: ServedScene): HTMLElement {
  const row = make('tr');
  const link = make('a', scene.id);
  link.href = `scene/${encodeURIComponent(scene.id)}/`;
  const cell = make('td');
  cell.append(link);
  row.append(cell, make('td', scene.owner || 'no name'), make('td', count(scene.objects), 'number'), make('td', count(scene.pairs), 'number'),
    make('td', count(scene.steps), 'number'), make('td', seconds(scene.step_seconds), 'number'));
  return row;
}
