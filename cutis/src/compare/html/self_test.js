"use strict";
// Proves that the page works, by what a person would do and see: events go in, styles and texts are read. Runs when the
// address ends in #selftest; the outcome stands in the title and in the element "selftest".
async function selfTest() {
  const byId = id => document.getElementById(id);
  const style = id => getComputedStyle(byId(id));
  const done = [], chosen = [byId("choose-a").value, byId("choose-b").value];
  const check = (holds, what) => { if (!holds) throw new Error(what); done.push(what); };
  const press = (key, more = {}) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, ...more }));
  const scale = () => new DOMMatrix(style("plane").transform).a;
  const left = () => Number(/inset\(0(?:px)? 0(?:px)? 0(?:px)? ([\d.]+)%?/.exec(style("image-b").clipPath)?.[1] ?? NaN);
  const pause = ms => new Promise(resolve => setTimeout(resolve, ms));
  const near = (a, b) => Math.abs(a - b) < 1e-3 * Math.max(1, Math.abs(b));

  await viewer.ready;
  const pictures = [...document.querySelectorAll("figure img")];
  await Promise.all(pictures.map(loaded));
  check(pictures.length > 0 && pictures.every(image => image.naturalWidth === Number(image.getAttribute("width"))), "every picture is whole");
  check([...document.images].every(image => image.src.startsWith("data:")), "pictures are inside the page");
  check(performance.getEntriesByType("resource").every(entry => entry.name.startsWith("data:")), "nothing came from outside");
  check(byId("image-a").src === byId(byId("choose-a").value).src, "A is the picture that is chosen");

  byId("wipe").value = 25;
  byId("wipe").dispatchEvent(new Event("input"));
  check(near(left(), 25), "the slider wipes");
  press("ArrowRight");
  check(near(left(), 26), "an arrow wipes");
  press("ArrowLeft", { shiftKey: true });
  check(near(left(), 16), "Shift and an arrow wipe farther");
  const box = byId("stage").getBoundingClientRect(), plane = byId("image-a").getBoundingClientRect();
  byId("stage").dispatchEvent(new PointerEvent("pointermove", { buttons: 1, clientX: plane.left + 0.75 * plane.width, clientY: box.top + 9 }));
  check(near(left(), 75), "the pointer wipes");

  check(scale() > 0 && plane.width <= box.width + 1 && plane.height <= box.height + 1, "the picture fits");
  const before = scale();
  press("+");
  check(near(scale(), 1.25 * before), "a key zooms in");
  byId("zoom-out").click();
  check(near(scale(), before), "a button zooms out");
  byId("stage").dispatchEvent(new WheelEvent("wheel", { ctrlKey: true, deltaY: -240, clientX: box.left + 30, clientY: box.top + 40, cancelable: true }));
  check(near(scale(), 2 * before), "the wheel zooms");
  press("0");
  check(near(scale(), before), "0 fits");

  byId("period").value = 100;
  press("b");
  check(style("image-b").clipPath === "none" && byId("mode-blink").getAttribute("aria-pressed") === "true", "b blinks");
  const seen = new Set();
  for (let i = 0; i < 12; i++) { seen.add(style("image-b").visibility); await pause(60); }
  check(seen.has("visible") && seen.has("hidden"), "both pictures are seen in turn");
  press(" ");
  const stopped = style("image-b").visibility;
  await pause(250);
  check(style("image-b").visibility === stopped, "Space stops the blinking");
  press(" ");
  check(style("image-b").visibility !== stopped, "Space shows the other picture");
  byId("mode-wipe").click();
  check(near(left(), 75), "the wipe is where it was");

  const options = [...byId("choose-a").options].map(option => option.value);
  const last = Math.min(options.length, 9);
  press(String(last), { code: `Digit${last}` });
  check(byId("image-a").src === byId(options[last - 1]).src, "a digit chooses A");
  press("!", { code: "Digit1", shiftKey: true });
  check(byId("image-b").src === byId(options[0]).src, "Shift and a digit choose B");
  const [a, b] = [byId("image-a").src, byId("image-b").src];
  press("x");
  check(byId("image-a").src === b && byId("image-b").src === a, "x swaps");
  byId("choose-b").value = options[0];
  byId("choose-b").dispatchEvent(new Event("change"));
  check(byId("label-b").textContent === `B: ${byId("choose-b").options[0].textContent}`, "the label says what is seen");

  // As it was, for whoever looks at the page afterwards.
  ["choose-a", "choose-b"].forEach((id, i) => { byId(id).value = chosen[i]; byId(id).dispatchEvent(new Event("change")); });
  byId("fit").click();
  return done;
}

if (location.hash === "#selftest") {
  const tell = words => { document.getElementById("selftest").textContent = words; document.title = words; };
  selfTest().then(
    done => tell(`self test passed: ${done.length} checks`),
    error => tell(`self test FAILED: ${error.message}`),
  );
}
