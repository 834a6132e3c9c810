// Plots zoom into the rectangle that is drawn with the pointer, or about the pointer with Ctrl and the wheel; they move
// when dragged with Shift; a double click shows one whole again, Escape all. The axes follow.
(function () {
  var first = document.querySelector('figure svg');
  if (!first) { return; }
  var NS = first.namespaceURI, panels = [];

  function make(name, attributes, parent) {
    var node = document.createElementNS(NS, name);
    Object.keys(attributes).forEach(function (key) { node.setAttribute(key, attributes[key]); });
    return parent.appendChild(node);
  }

  function numbers(text) { return text.split(' ').map(Number); }

  // Round values, about `count` between low and high, with the decimals that their step needs.
  function ticks(low, high, count) {
    var rough = (high - low) / count, power = Math.pow(10, Math.floor(Math.log10(rough)));
    var step = [1, 2, 5, 10].map(function (f) { return f * power; }).find(function (s) { return s >= 0.999 * rough; });
    var decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    var found = [];
    for (var k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * (high - low); k += 1) {
      found.push([k * step, decimals > 6 ? (k * step).toExponential(2) : (k * step).toFixed(decimals).replace('-', '−')]);
    }
    return found;
  }

  function Panel(data) {
    var box = numbers(data.getAttribute('viewBox'));
    this.data = data;
    this.outer = data.ownerSVGElement;
    this.box = { x: box[0], y: box[1], width: box[2], height: box[3] };
    this.view = Object.assign({}, this.box);
    this.x = numbers(data.dataset.x);
    this.y = data.dataset.y ? numbers(data.dataset.y) : null;
    this.whole = data.previousElementSibling;
    while (this.whole && this.whole.getAttribute('class') !== 'ticks') { this.whole = this.whole.previousElementSibling; }
    this.drawn = null;
  }

  // Dots are drawn as strokes, whose width a zoom leaves alone.
  Panel.prototype.prepare = function () {
    this.data.querySelectorAll('circle').forEach(function (circle) {
      var dot = document.createElementNS(NS, 'path');
      dot.setAttribute('d', 'M' + circle.getAttribute('cx') + ' ' + circle.getAttribute('cy') + 'h0.001');
      dot.setAttribute('stroke', circle.getAttribute('fill'));
      dot.setAttribute('stroke-width', 2 * circle.getAttribute('r'));
      dot.setAttribute('stroke-linecap', 'round');
      circle.replaceWith(dot);
    });
    this.prepare = function () {};
  };

  Panel.prototype.isWhole = function () { return this.view.width === this.box.width && this.view.height === this.box.height; };

  Panel.prototype.show = function () {
    var box = this.box, view = this.view;
    this.prepare();
    this.data.setAttribute('viewBox', [view.x, view.y, view.width, view.height].join(' '));
    if (this.drawn) { this.drawn.remove(); this.drawn = null; }
    if (!this.whole) { return; }
    this.whole.style.display = this.isWhole() ? '' : 'none';
    if (this.isWhole()) { return; }
    var group = make('g', {}, this.outer), bottom = box.y + box.height;
    this.outer.insertBefore(group, this.data);
    function line(x1, y1, x2, y2) { make('path', { d: 'M' + x1 + ' ' + y1 + 'L' + x2 + ' ' + y2, stroke: '#e3e3e3', 'stroke-width': 0.8 }, group); }
    function label(x, y, anchor, text) { make('text', { x: x, y: y, 'text-anchor': anchor, 'font-size': 12, fill: '#222222' }, group).textContent = text; }
    var xs = this.x, ys = this.y;
    function value(ends, share) { return ends[0] + share * (ends[1] - ends[0]); }
    var left = value(xs, (view.x - box.x) / box.width), right = value(xs, (view.x + view.width - box.x) / box.width);
    ticks(left, right, Math.max(2, box.width / 80)).forEach(function (tick) {
      var at = box.x + (tick[0] - left) / (right - left) * box.width;
      line(at, box.y, at, bottom);
      label(at, bottom + 15, 'middle', tick[1]);
    });
    if (ys) {
      var high = value(ys, 1 - (view.y - box.y) / box.height), low = value(ys, 1 - (view.y + view.height - box.y) / box.height);
      ticks(low, high, Math.max(2, box.height / 36)).forEach(function (tick) {
        var at = bottom - (tick[0] - low) / (high - low) * box.height;
        line(box.x, at, box.x + box.width, at);
        label(box.x - 6, at + 4, 'end', tick[1]);
      });
    }
    this.drawn = group;
  };

  // Sets the view, within the whole and never finer than a five hundredth of it.
  Panel.prototype.set = function (x, y, width, height) {
    var box = this.box;
    if (!this.y) { y = box.y; height = box.height; }
    width = Math.min(box.width, Math.max(box.width / 500, width));
    height = Math.min(box.height, Math.max(box.height / 500, height));
    this.view = {
      x: Math.min(Math.max(x, box.x), box.x + box.width - width), y: Math.min(Math.max(y, box.y), box.y + box.height - height),
      width: width, height: height
    };
    this.show();
  };

  Panel.prototype.reset = function () { this.set(this.box.x, this.box.y, this.box.width, this.box.height); };

  // The pointer's place in the picture, and in what the panel shows.
  Panel.prototype.point = function (event) {
    var frame = this.outer.getBoundingClientRect(), whole = this.outer.viewBox.baseVal, box = this.box, view = this.view;
    var x = (event.clientX - frame.left) / frame.width * whole.width, y = (event.clientY - frame.top) / frame.height * whole.height;
    x = Math.min(Math.max(x, box.x), box.x + box.width);
    y = Math.min(Math.max(y, box.y), box.y + box.height);
    return { x: x, y: y, dataX: view.x + (x - box.x) / box.width * view.width, dataY: view.y + (y - box.y) / box.height * view.height };
  };

  Panel.prototype.listen = function () {
    var panel = this, box = this.box, begin = null, mark = null;
    // A surface that takes the pointer wherever the data leave holes.
    var surface = make('rect', { x: box.x, y: box.y, width: box.width, height: box.height, fill: 'transparent' }, this.outer);
    surface.style.cursor = 'crosshair';
    function end() { begin = null; if (mark) { mark.remove(); mark = null; } }
    surface.addEventListener('pointerdown', function (event) {
      if (event.pointerType === 'touch' || event.button !== 0) { return; }
      event.preventDefault();
      surface.setPointerCapture(event.pointerId);
      begin = { at: panel.point(event), view: Object.assign({}, panel.view), move: event.shiftKey };
      if (!begin.move) { mark = make('rect', { fill: '#12376b', 'fill-opacity': 0.15, stroke: '#12376b', 'pointer-events': 'none' }, panel.outer); }
    });
    surface.addEventListener('pointermove', function (event) {
      if (!begin) { return; }
      var at = panel.point(event), view = begin.view;
      if (begin.move) {
        panel.set(view.x - (at.x - begin.at.x) / box.width * view.width, view.y - (at.y - begin.at.y) / box.height * view.height, view.width, view.height);
        return;
      }
      mark.setAttribute('x', Math.min(at.x, begin.at.x));
      mark.setAttribute('width', Math.abs(at.x - begin.at.x));
      mark.setAttribute('y', panel.y ? Math.min(at.y, begin.at.y) : box.y);
      mark.setAttribute('height', panel.y ? Math.abs(at.y - begin.at.y) : box.height);
    });
    surface.addEventListener('pointerup', function (event) {
      if (!begin) { return; }
      var at = panel.point(event), from = begin;
      end();
      var wide = Math.abs(at.x - from.at.x) > 5, high = Math.abs(at.y - from.at.y) > 5;
      if (from.move || !(wide || high)) { return; }
      // A rectangle without width or height zooms along the other axis alone.
      panel.set(
        wide ? Math.min(at.dataX, from.at.dataX) : panel.view.x, high ? Math.min(at.dataY, from.at.dataY) : panel.view.y,
        wide ? Math.abs(at.dataX - from.at.dataX) : panel.view.width, high ? Math.abs(at.dataY - from.at.dataY) : panel.view.height);
    });
    surface.addEventListener('pointercancel', end);
    surface.addEventListener('dblclick', function (event) { event.preventDefault(); panel.reset(); });
    surface.addEventListener('wheel', function (event) {
      if (!event.ctrlKey) { return; }
      event.preventDefault();
      var at = panel.point(event), factor = Math.exp(0.002 * event.deltaY), view = panel.view;
      panel.set(at.dataX - (at.dataX - view.x) * factor, at.dataY - (at.dataY - view.y) * factor, view.width * factor, view.height * factor);
    }, { passive: false });
  };

  document.querySelectorAll('figure svg.data').forEach(function (data) { panels.push(new Panel(data)); });
  panels.forEach(function (panel) { panel.listen(); });
  document.addEventListener('keydown', function (event) {
    if (event.key === 'Escape') { panels.forEach(function (panel) { panel.reset(); }); }
  });
}());
