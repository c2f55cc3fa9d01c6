// page.js - put into a copy of the report's page by page.sh; writes "ok NAME" and "FAIL NAME: WHY" lines into <pre id="selftest">.
'use strict';
window.addEventListener('load', () => {
  const lines = [];
  const check = (name, good, why) => lines.push(good ? 'ok ' + name : 'FAIL ' + name + ': ' + why);
  const all = (selector, root) => [...(root || document).querySelectorAll(selector)];
  const text = document.getElementById('beside').textContent;
  const report = JSON.parse(text);

  check('the JSON inside is report.json', document.getElementById('report').textContent === text, 'they differ');

  // Every number is that of report.json at its key, and is shown rounded.
  const shown = (s) => {
    if (s.includes(':')) return s.split(':').reduce((sum, part) => 60 * sum + Number(part), 0);
    return parseFloat(s.replaceAll(',', '')) / (s.includes('%') ? 100 : 1);
  };
  const numbers = all('data');
  check('there are numbers', numbers.length > 20, numbers.length);
  const wrong = numbers.filter((d) => {
    const want = d.dataset.key.split('.').reduce((at, key) => at === undefined ? at : at[key], report);
    const near = Math.abs(shown(d.textContent) - want) <= 0.006 * Math.abs(want) + 0.051 * /×/.test(d.textContent) +
      0.51 * /^[\d,:]+$/.test(d.textContent);
    return typeof want !== 'number' || Number(d.value) !== want || !near;
  });
  check('numbers equal report.json', !wrong.length, wrong.slice(0, 5).map((d) => d.dataset.key + ' "' + d.textContent + '"').join(' '));

  const images = all('img');
  const broken = images.filter((i) => !i.complete || i.naturalWidth !== i.width && i.naturalWidth !== Number(i.getAttribute('width')));
  check('pictures are whole', images.length > 20 && !broken.length, broken.length + ' of ' + images.length);
  const loaded = performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:'));
  check('nothing is loaded', !loaded.length, loaded.map((e) => e.name).join(' '));

  for (const figure of all('.compare')) {
    const range = figure.querySelector('input[type=range]'), layers = all('.over', figure), radios = all('input[type=radio]', figure);
    for (const at of [0, 20, 100]) {
      range.value = at;
      range.dispatchEvent(new Event('input', { bubbles: true }));
      const clip = getComputedStyle(layers[0]).clipPath, line = parseFloat(getComputedStyle(figure.querySelector('.line')).left);
      check('slider at ' + at, clip.replace(/0px/g, '0') === 'inset(0 0 0 ' + at + '%)' && Math.abs(line - at / 100 * range.clientWidth) < 1, clip + ' ' + line);
    }
    range.value = 50;
    range.dispatchEvent(new Event('input', { bubbles: true }));
    figure.scrollIntoView({ block: 'center' });
    const box = figure.querySelector('.stage').getBoundingClientRect();
    for (const share of [0.1, 0.5, 0.9]) {
      const met = document.elementFromPoint(box.left + share * box.width, box.top + box.height / 2);
      check('a pointer meets the slider at ' + share, met === range, met && met.outerHTML.slice(0, 60));
    }
    radios[1].click();
    check('many representatives', layers[0].hidden && !layers[1].hidden && getComputedStyle(layers[0]).display === 'none', 'not shown');
    radios[0].click();
    check('one representative', !layers[0].hidden && layers[1].hidden, 'not shown');
  }
  for (const control of all('input, button, a, [tabindex]')) {
    control.focus();
    if (document.activeElement !== control) check('keyboard', false, control.outerHTML.slice(0, 60));
  }
  const button = document.querySelector('.maps button'), before = button.clientWidth;
  button.click();
  check('a map grows', button.clientWidth > 1.5 * before && button.getAttribute('aria-pressed') === 'true', button.clientWidth);
  button.click();
  check('and shrinks', button.clientWidth === before, button.clientWidth);

  const plots = all('svg.lc-plot');
  check('plots', plots.length === 5 * report.scenes.length && plots.every((p) => p.querySelectorAll('.lc-line').length >= 2), plots.length);
  check('plots hold numbers', plots.every((p) => !/"[^"]*(nan|inf)[^"]*"/i.test(p.innerHTML.replace(/<text.*?<\/text>/g, ''))), 'nan or inf');
  if (location.search === '?dark') check('a phone', innerWidth === 390, innerWidth);
  check('nothing is wider than the screen', document.documentElement.scrollWidth <= innerWidth,
    document.documentElement.scrollWidth + ' of ' + innerWidth);
  const dark = location.search === '?dark', back = dark ? 'rgb(13, 17, 23)' : 'rgb(255, 255, 255)';
  check('colours of the scheme', getComputedStyle(document.body).backgroundColor === back &&
    getComputedStyle(document.querySelector('.lc-back')).fill === back, getComputedStyle(document.body).backgroundColor);
  check('no errors', !window.pageErrors.length, window.pageErrors.join('; '));

  const pre = document.createElement('pre');
  pre.id = 'selftest';
  pre.textContent = '\n' + lines.join('\n') + '\nend\n';
  if (parent !== window) parent.postMessage(pre.textContent, '*');
  else document.body.append(pre);
});
