// Pictures zoom about the pointer with Ctrl + wheel or a double click, move when dragged, and go back with Escape.
document.querySelectorAll('figure > svg').forEach(function (svg) {
  var whole = svg.getAttribute('viewBox').split(' ').map(Number);
  var view = whole.slice();
  var grip = null;
  function show() { svg.setAttribute('viewBox', view.join(' ')); }
  function point(event) {
    var box = svg.getBoundingClientRect();
    return [view[0] + (event.clientX - box.left) / box.width * view[2],
            view[1] + (event.clientY - box.top) / box.height * view[3]];
  }
  function zoom(event, factor) {
    var at = point(event);
    var size = Math.min(1, Math.max(0.02, view[2] * factor / whole[2]));
    var width = whole[2] * size, height = whole[3] * size;
    view = [at[0] - (at[0] - view[0]) * width / view[2], at[1] - (at[1] - view[1]) * height / view[3], width, height];
    if (size === 1) { view = whole.slice(); }
    show();
  }
  svg.addEventListener('wheel', function (event) {
    if (!event.ctrlKey) { return; }
    event.preventDefault();
    zoom(event, Math.exp(0.002 * event.deltaY));
  }, { passive: false });
  svg.addEventListener('dblclick', function (event) { event.preventDefault(); zoom(event, event.shiftKey ? 2 : 0.5); });
  svg.addEventListener('pointerdown', function (event) {
    if (view[2] === whole[2]) { return; }
    grip = point(event);
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener('pointermove', function (event) {
    if (grip === null) { return; }
    var at = point(event);
    view[0] += grip[0] - at[0];
    view[1] += grip[1] - at[1];
    show();
  });
  svg.addEventListener('pointerup', function () { grip = null; });
  document.addEventListener('keydown', function (event) {
    if (event.key === 'Escape') { view = whole.slice(); show(); }
  });
});
