// Compute pipelines compiled ahead on the browser's own threads. The program makes its pipelines at
// once, which stops the whole browser while a large one is compiled. Between `compileAhead` and
// `compiledAhead` they are compiled in the background instead, and what the program gets stands for
// nothing; a browser that keeps compiled pipelines then has them ready when they are made in earnest.

const kept = [];
let coming = null;
let makeAtOnce = null;

export function compileAhead() {
  const prototype = globalThis.GPUDevice?.prototype;
  if (!prototype?.createComputePipelineAsync || coming) return;
  coming = [];
  makeAtOnce = prototype.createComputePipeline;
  prototype.createComputePipeline = function (descriptor) {
    coming.push(this.createComputePipelineAsync(descriptor));
    return {};
  };
}

export async function compiledAhead() {
  if (!coming) return;
  globalThis.GPUDevice.prototype.createComputePipeline = makeAtOnce;
  const all = coming;
  coming = null;
  kept.push(...(await Promise.all(all)));
}
