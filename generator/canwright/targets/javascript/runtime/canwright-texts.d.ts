/** A text by language. */
export interface Text {
  readonly en?: string;
  readonly zh?: string;
}

/** Texts with the parameter values under which they apply; these are empty if they always apply. null is unknown. */
export type ByParameter = readonly (readonly [values: string, text: string | null])[];

/** Titles of an edition, for people. What has no title is left out. */
export interface EditionTexts {
  readonly family: string;
  readonly edition: string;
  readonly date?: string;
  readonly languages: readonly string[];
  readonly title?: Text;
  readonly parameters: { readonly [name: string]: { readonly title?: Text; readonly values?: { readonly [value: string]: Text } } };
  readonly effects: { readonly [name: string]: { readonly level: "note" | "warning" | "danger"; readonly title?: Text } };
  readonly commands: {
    readonly [name: string]: {
      readonly code?: number;
      readonly title?: Text;
      /** The section of the manual. */
      readonly manual?: string;
      /** The parameter values under which the command exists. */
      readonly only?: { readonly [parameter: string]: readonly string[] };
      readonly effects?: readonly string[];
      /** False if the manual announces the command and the firmware lacks it. */
      readonly implemented?: false;
    };
  };
  /** The fields of each layout, with the positions that `MESSAGES` has, each with the position of its type. */
  readonly layouts: readonly (readonly { readonly title?: Text; readonly type: number }[])[];
  readonly types: readonly {
    readonly resolution?: ByParameter;
    readonly range?: ByParameter;
    readonly members?: { readonly [name: string]: Text };
  }[];
}
