// The connection to web_door. Connects again when it is lost, and not after a refusal.

const RETRY = 2000; // [ms]
const REFUSED = 1008; // close code of a message that was not allowed

export class Link {
  // take: functions by kind of message (welcome, scene, training, frame, ping, person, refused); say(text): for the person.
  constructor(take, say) {
    this.take = take;
    this.say = say;
    this.unsent = 0; // frames of hands that were left out as the one before was still on its way
    this.connect();
  }

  connect() {
    const address = new URL('socket', location.href);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    this.socket = new WebSocket(address);
    this.socket.onopen = () => {
      this.say('');
      this.take.connected();
    };
    this.socket.onmessage = (event) => {
      const [kind, content] = Object.entries(JSON.parse(event.data))[0];
      if (kind === 'ping') this.tell({pong: [content[0], performance.now()]});
      if (this.take[kind]) this.take[kind](content);
    };
    this.socket.onclose = (event) => {
      this.say(event.reason ? `web_door: ${event.reason}` : 'no connection to web_door');
      if (event.code !== REFUSED) setTimeout(() => this.connect(), RETRY);
    };
  }

  get open() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  tell(content) {
    if (this.open) this.socket.send(JSON.stringify(content));
  }

  // Hands are left out while older ones wait: what arrives late helps nobody.
  sendHands(data) {
    if (!this.open) return;
    if (this.socket.bufferedAmount > 0) {
      this.unsent += 1;
      return;
    }
    this.socket.send(data);
  }
}
