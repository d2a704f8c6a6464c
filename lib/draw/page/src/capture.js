// A screenshot and a video of the picture, as files.

const VIDEO_TYPES = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'];
const VIDEO_BITS = 12e6; // per second
const VIDEO_RATE = 60;

function download(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const plain = (title) => title.replace(/[^\p{L}\p{N}._-]+/gu, '_').replace(/^_+|_+$/g, '') || 'krok';

// The canvas with the legend of a difference below it, if there is one.
function composed(canvas, legend) {
  const picture = document.createElement('canvas');
  picture.width = canvas.width;
  picture.height = canvas.height;
  const pen = picture.getContext('2d');
  pen.drawImage(canvas, 0, 0);
  if (legend) legend(pen, picture.width, picture.height);
  return picture;
}

export async function screenshot(stage, player, title, legend) {
  stage.redraw();
  stage.draw(); // the picture is there until the browser shows it
  const blob = await new Promise((made) => { composed(stage.canvas, legend).toBlob(made, 'image/png'); });
  const frame = String(Math.round(player.time * player.rate)).padStart(4, '0');
  download(blob, `${plain(title)}_${frame}.png`);
}

// Records one pass over the motion, or over the range that is looped.
export class Recorder {
  constructor(stage, player, title, changed) {
    Object.assign(this, { stage, player, title, changed });
  }

  get supported() {
    return Boolean(globalThis.MediaRecorder && this.stage.canvas.captureStream);
  }

  get recording() {
    return this.recorder?.state === 'recording';
  }

  toggle() {
    if (this.recording) this.stop();
    else this.start();
  }

  start() {
    const { player, stage } = this;
    const mimeType = VIDEO_TYPES.find((type) => MediaRecorder.isTypeSupported(type));
    const stream = stage.canvas.captureStream(VIDEO_RATE);
    const parts = [];
    this.recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: VIDEO_BITS });
    this.recorder.addEventListener('dataavailable', ({ data }) => parts.push(data));
    this.recorder.addEventListener('stop', () => {
      stream.getTracks().forEach((track) => track.stop());
      const type = this.recorder.mimeType.split(';')[0];
      download(new Blob(parts, { type }), `${plain(this.title)}.${type === 'video/mp4' ? 'mp4' : 'webm'}`);
      this.changed();
    });
    this.loop = player.loop;
    player.loop = false;
    player.setTime(player.begin);
    player.ended = () => this.stop();
    // On a busy machine a short motion would be over before the first picture is taken.
    this.recorder.addEventListener('start', () => {
      stage.redraw();
      player.playing = Boolean(player.ended);
      player.changed();
    });
    this.recorder.start();
    this.changed();
  }

  stop() {
    const { player } = this;
    player.loop = this.loop;
    player.ended = null;
    player.playing = false;
    // The last picture still has to be drawn.
    requestAnimationFrame(() => {
      this.stage.redraw();
      requestAnimationFrame(() => requestAnimationFrame(() => this.recorder.stop()));
    });
    player.changed();
  }
}
