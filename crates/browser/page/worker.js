// In a worker: steps through a deck, and tells the page of each increment. A worker runs one deck.
let calls;

const told = () =>
  new TextDecoder().decode(new Uint8Array(calls.memory.buffer, calls.text(), calls.length()));

onmessage = async ({ data: { module, deck } }) => {
  try {
    calls = (await WebAssembly.instantiate(module, {})).exports;
    const bytes = new TextEncoder().encode(deck);
    // Room may grow the memory: only then is it looked at.
    const at = calls.room(bytes.length);
    new Uint8Array(calls.memory.buffer, at, bytes.length).set(bytes);
    if (!calls.open()) {
      postMessage({ kind: "refused", text: told() });
      return;
    }
    const start = performance.now();
    let computing = 0;
    for (;;) {
      const before = performance.now();
      const goesOn = calls.advance();
      computing += performance.now() - before;
      if (!goesOn) break;
      postMessage({ kind: "increment", text: told() });
    }
    calls.outcome();
    postMessage({ kind: "outcome", text: told(), computing, elapsed: performance.now() - start });
  } catch (error) {
    postMessage({ kind: "failed", text: String(error) });
  }
};
