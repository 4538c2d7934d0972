// SPDX-FileCopyrightText: The mneme authors
// SPDX-License-Identifier: BSD-3-Clause

/** The planner in the page: a WebAssembly module in a worker, which answers as the service does. */
import type { Live } from "./trace";

export interface Reply {
  status: number;
  // eslint-disable-next-line @typescript-eslint/no-explicit-any
  json: any;
}

/** Gzip in base64, as `mneme view --live` writes it into an element of the page. */
async function bytesOf(id: string): Promise<ArrayBuffer> {
  const text = document.getElementById(id)?.textContent;
  if (!text) throw new Error("this page lacks its planner: write it anew with 'mneme view --live'");
  const packed = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** The end of the worker's script, behind that of emscripten, which defines mnemePlanner(). */
const WORKER = `
let planner = null;
async function open({ wasm, files, problem }) {
  const module = await mnemePlanner({ wasmBinary: wasm });
  planner = {
    addFile: module.cwrap("mneme_add_file", "number", ["string", "string"]),
    open: module.cwrap("mneme_open", "number", ["string"]),
    call: module.cwrap("mneme_call", "number", ["string", "string"]),
    answer: module.cwrap("mneme_answer", "string", []),
  };
  for (const { path, text } of files) planner.addFile(path, text);
  return planner.open(problem);
}
onmessage = async ({ data }) => {
  try {
    const status = data.path ? planner.call(data.path, data.body ?? "") : await open(data);
    postMessage({ status, json: JSON.parse(planner.answer()) });
  } catch (error) {
    postMessage({ status: 500, json: { error: { message: "the planner in the page failed: " + error } } });
  }
};`;

export class OwnPlanner {
  private parts: Promise<{ script: string; wasm: ArrayBuffer }>;
  private worker: Promise<Worker> | null = null;

  constructor(private readonly planner: NonNullable<Live["planner"]>) {
    this.parts = Promise.all([bytesOf("planner-code"), bytesOf("planner-wasm")]).then(([code, wasm]) => ({
      script: URL.createObjectURL(new Blob([code, WORKER], { type: "text/javascript" })), wasm,
    }));
    this.worker = this.begin();
  }

  /** As fetch(); a request that is given up ends the worker, and the next one begins another. */
  async reach(path: string, body: string | null, signal: AbortSignal): Promise<Reply> {
    this.worker ??= this.begin();
    const worker = await this.worker;
    signal.throwIfAborted();
    return this.ask(worker, { path, body }, signal);
  }

  private async begin(): Promise<Worker> {
    const { script, wasm } = await this.parts;
    const worker = new Worker(script);
    const { status, json } = await this.ask(worker, { wasm, ...this.planner });
    if (status !== 200) throw new Error(json.error.message);
    return worker;
  }

  private ask(worker: Worker, message: object, signal?: AbortSignal): Promise<Reply> {
    return new Promise((resolve, reject) => {
      const giveUp = () => {
        worker.terminate();
        this.worker = null;
        reject(signal!.reason);
      };
      signal?.addEventListener("abort", giveUp, { once: true });
      worker.onmessage = ({ data }) => {
        signal?.removeEventListener("abort", giveUp);
        resolve(data);
      };
      worker.onerror = ({ message: text }) => reject(new Error(`the planner in the page failed: ${text}`));
      worker.postMessage(message);
    });
  }
}
