// Shows the viewer, a page within this page, in place of the drawings. Prints on paper still have the drawings.

// ---- Viewer --------------------------------------------------------------------------------------------------------

let viewerFrame = null;

async function startViewer() {
  const data = element('viewer')?.textContent;
  if (!data || !('DecompressionStream' in window)) return;
  const bytes = Uint8Array.from(atob(data), c => c.charCodeAt(0));
  const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  const page = new Blob([await new Response(unpacked).arrayBuffer()], {type: 'text/html;charset=utf-8'});
  viewerFrame = document.createElement('iframe');
  viewerFrame.title = 'Viewer';
  viewerFrame.src = URL.createObjectURL(page);
  addEventListener('message', event => {
    if (event.source !== viewerFrame.contentWindow) return;
    if (event.data?.viewer === 'ready') showInViewer(chosen);
    if (event.data?.viewer === 'failed') endViewer();
  });
  document.documentElement.classList.add('has-viewer');
  element('picture').prepend(viewerFrame);
}
function endViewer() {
  document.documentElement.classList.remove('has-viewer');
  viewerFrame.remove();
  viewerFrame = null;
  drawSoon();
}
// In the viewer, the objects of the second set have the numbers after those of the first.
function showInViewer(row) {
  const objects = !row || isGone(row) ? [] : [row.a, row.b + (summary.join ? summary.first : 0)];
  viewerFrame?.contentWindow.postMessage({select: objects}, '*');
}
