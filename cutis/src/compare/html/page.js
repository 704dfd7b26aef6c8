"use strict";
// Waits until a picture is there, or cannot be.
const loaded = image => image.complete ? Promise.resolve() : new Promise(done => {
  image.addEventListener("load", done);
  image.addEventListener("error", done);
});

// The viewer: two pictures of the page over each other, wiped or blinked, zoomed and moved.
const viewer = (() => {
  const byId = id => document.getElementById(id);
  const stage = byId("stage"), plane = byId("plane"), handle = byId("handle");
  const images = { a: byId("image-a"), b: byId("image-b") };
  const choices = { a: byId("choose-a"), b: byId("choose-b") };
  const state = { mode: "wipe", wipe: 50, frontShown: true, zoom: 1, x: 0, y: 0 };
  const between = (value, low, high) => Math.min(high, Math.max(low, value));
  const size = () => ({ width: images.a.naturalWidth || 1, height: images.a.naturalHeight || 1 });
  let timer = 0;

  function draw() {
    const wiping = state.mode === "wipe";
    plane.style.transform = `translate(${state.x}px, ${state.y}px) scale(${state.zoom})`;
    images.b.style.clipPath = wiping ? `inset(0 0 0 ${state.wipe}%)` : "none";
    images.b.style.visibility = wiping || state.frontShown ? "visible" : "hidden";
    for (const image of Object.values(images)) image.classList.toggle("sharp", state.zoom >= 2);
    const { width, height } = size();
    handle.hidden = !wiping;
    handle.style.left = `${width * state.wipe / 100}px`;
    handle.style.height = `${height}px`;
    handle.style.borderLeftWidth = `${1.5 / state.zoom}px`;
    const name = choice => choice.selectedOptions[0].textContent;
    byId("label-a").textContent = `A: ${name(choices.a)}`;
    byId("label-b").textContent = `B: ${name(choices.b)}`;
    byId("label-a").style.opacity = wiping || !state.frontShown ? 1 : 0.3;
    byId("label-b").style.opacity = wiping || state.frontShown ? 1 : 0.3;
    byId("wipe").value = state.wipe;
    byId("wipe-control").hidden = !wiping;
    byId("period-control").hidden = wiping;
    byId("mode-wipe").setAttribute("aria-pressed", wiping);
    byId("mode-blink").setAttribute("aria-pressed", !wiping);
    byId("zoom").textContent = `${Math.round(100 * state.zoom)} %`;
    stage.style.cursor = wiping ? "ew-resize" : "grab";
  }

  function choose(which, id) {
    choices[which].value = id;
    images[which].src = byId(id).src;
    draw();
  }

  function swap() {
    const [a, b] = [choices.a.value, choices.b.value];
    choose("a", b);
    choose("b", a);
  }

  function blinkFrom(shown) {
    clearInterval(timer);
    state.frontShown = shown;
    const period = between(Number(byId("period").value) || 500, 100, 5000);
    if (state.mode === "blink") timer = setInterval(() => { state.frontShown = !state.frontShown; draw(); }, period);
    draw();
  }

  function setMode(mode) {
    state.mode = mode;
    blinkFrom(true);
  }

  // Stops blinking and shows the other picture; blinking again starts it anew.
  function flip() {
    if (state.mode === "wipe") state.mode = "blink";
    clearInterval(timer);
    state.frontShown = !state.frontShown;
    draw();
  }

  function setWipe(percent) {
    state.wipe = between(percent, 0, 100);
    draw();
  }

  // Zooms so that the place under (x, y) of the stage stays where it is.
  function zoomTo(zoom, x = stage.clientWidth / 2, y = stage.clientHeight / 2) {
    const next = between(zoom, 0.05, 64), ratio = next / state.zoom;
    state.x = x - (x - state.x) * ratio;
    state.y = y - (y - state.y) * ratio;
    state.zoom = next;
    draw();
  }

  function fit() {
    const { width, height } = size();
    state.zoom = Math.min(stage.clientWidth / width, stage.clientHeight / height);
    state.x = (stage.clientWidth - width * state.zoom) / 2;
    state.y = (stage.clientHeight - height * state.zoom) / 2;
    draw();
  }

  function chooseNth(which, n) {
    const option = choices[which].options[n];
    if (option) choose(which, option.value);
  }

  const keys = {
    ArrowLeft: e => setWipe(state.wipe - (e.shiftKey ? 10 : 1)),
    ArrowRight: e => setWipe(state.wipe + (e.shiftKey ? 10 : 1)),
    b: () => setMode(state.mode === "wipe" ? "blink" : "wipe"),
    " ": flip, x: swap,
    "+": () => zoomTo(state.zoom * 1.25), "-": () => zoomTo(state.zoom / 1.25), 0: fit,
  };

  function onKey(e) {
    if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|BUTTON|SUMMARY)$/.test(e.target.tagName)) return;
    const digit = /^Digit([1-9])$/.exec(e.code);
    if (digit) chooseNth(e.shiftKey ? "b" : "a", Number(digit[1]) - 1);
    else if (keys[e.key]) keys[e.key](e);
    else return;
    e.preventDefault();
  }

  function onPointer(e) {
    if (!e.buttons) return;
    if (e.type === "pointerdown") stage.setPointerCapture(e.pointerId);
    if (state.mode === "wipe" && !e.shiftKey) {
      const x = e.clientX - stage.getBoundingClientRect().left;
      setWipe(100 * (x - state.x) / (size().width * state.zoom));
    } else if (e.type === "pointermove") {
      state.x += e.movementX;
      state.y += e.movementY;
      draw();
    }
  }

  function onWheel(e) {
    if (!e.ctrlKey) return;
    e.preventDefault();
    const box = stage.getBoundingClientRect();
    zoomTo(state.zoom * 2 ** (-e.deltaY / 240), e.clientX - box.left, e.clientY - box.top);
  }

  async function start() {
    for (const which of ["a", "b"]) {
      choices[which].addEventListener("change", () => choose(which, choices[which].value));
      choose(which, choices[which].value);
    }
    byId("swap").addEventListener("click", swap);
    byId("mode-wipe").addEventListener("click", () => setMode("wipe"));
    byId("mode-blink").addEventListener("click", () => setMode("blink"));
    byId("period").addEventListener("change", () => blinkFrom(true));
    byId("wipe").addEventListener("input", () => setWipe(Number(byId("wipe").value)));
    byId("zoom-in").addEventListener("click", () => zoomTo(state.zoom * 1.25));
    byId("zoom-out").addEventListener("click", () => zoomTo(state.zoom / 1.25));
    byId("fit").addEventListener("click", fit);
    stage.addEventListener("pointerdown", onPointer);
    stage.addEventListener("pointermove", onPointer);
    stage.addEventListener("wheel", onWheel, { passive: false });
    document.addEventListener("keydown", onKey);
    window.addEventListener("resize", fit);
    await Promise.all(Object.values(images).map(loaded));
    fit();
  }
  return { ready: start() };
})();
